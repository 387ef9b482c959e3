# SPDX-License-Identifier: Apache-2.0
"""Names of signals by pattern."""
from __future__ import annotations

import fnmatch

from ._rths import Error


def matching(names: list[str], patterns: tuple[str, ...], place: str) -> list[str]:
    """The names that match a pattern (`*`, `?`), all without a pattern. Raises Error for a pattern without a match."""
    for pattern in patterns:
        if not any(fnmatch.fnmatchcase(name, pattern) for name in names):
            raise Error(f"{place} has no signal '{pattern}', expected one such as: {', '.join(names[:5])}, …")
    return [name for name in names if not patterns or any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)]

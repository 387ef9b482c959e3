# SPDX-License-Identifier: Apache-2.0
"""The installed command, and the maps that are installed with it."""
from __future__ import annotations

import os
import pathlib
import shutil

from ._rths import Error


def command() -> pathlib.Path:
    """Path of the command: that of RTHS_COMMAND, of the installation of this package, or of PATH.

    Raises Error if there is none.
    """
    named = os.environ.get("RTHS_COMMAND")
    beside = [folder / "bin" / "rths" for folder in pathlib.Path(__file__).absolute().parents[1:6]]
    for file in [pathlib.Path(named)] if named else beside:
        if file.is_file() and os.access(file, os.X_OK):
            return file
    found = None if named else shutil.which("rths")
    if found is None:
        raise Error(f"RTHS_COMMAND is '{named}', expected the command rths" if named else
                    "the command rths was not found, expected it in PATH or in RTHS_COMMAND")
    return pathlib.Path(found)


def map_file(map: str | pathlib.Path) -> str:
    """File of a map: a path, or the name of a map that is installed with the command."""
    text = str(map)
    if "/" in text or "." in text or pathlib.Path(text).is_file():
        return text
    maps = command().resolve().parent.parent / "share" / "rths" / "maps"
    file = maps / f"{text}.ringmap.toml"
    if not file.is_file():
        names = sorted(known.name.removesuffix(".ringmap.toml") for known in maps.glob("*.ringmap.toml"))
        raise Error(f"there is no map '{text}', expected a file or one of: {', '.join(names)}")
    return str(file)

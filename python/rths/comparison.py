# SPDX-License-Identifier: Apache-2.0
"""Two runs, recordings or tables, compared by the installed command."""
from __future__ import annotations

import dataclasses
import pathlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._rths import Error
from .runs import _ended, _result_of, _table

if TYPE_CHECKING:
    import pandas


@dataclasses.dataclass(frozen=True)
class ComparedSignal:
    """A signal beside that of the baseline. All values are in SI."""

    signal: str
    other: str  #: its name in the other
    unit: str
    samples: int  #: compared rows
    equal: bool  #: to the last bit
    unmatched_rows: int  #: with a number in one of both alone
    peak: float
    other_peak: float
    rms_difference: float
    relative_rms: float | None  #: over the standard deviation of the baseline; None: that is 0
    largest_difference: float
    largest_difference_at_s: float
    delay_s: float | None  #: behind the baseline; None: nothing correlates
    gain: float  #: at this delay
    resemblance: str  #: "none", "unit", "sign", "scale", "offset", "delay" or "other"
    explanation: str  #: of the resemblance
    broken_at_s: float | None  #: where the tolerance is first broken; None: nowhere, or not judged
    broken_samples: int


@dataclasses.dataclass(frozen=True)
class Comparison:
    """The result of `compare`. `numbers` holds all of `rths compare --json`."""

    settings: tuple[tuple[str, str, str], ...]  #: that differ: key, baseline, other; empty texts: absent
    signals: tuple[ComparedSignal, ...]  #: outside their tolerance, then the most different
    only_baseline: tuple[str, ...]
    only_other: tuple[str, ...]
    shift_s: float  #: removed from all times of the other
    judged: bool  #: there was a tolerance
    why: Mapping[str, Any] | None  #: "sentence", "causes", "mistakes", "model", "reversed"; None: not asked
    numbers: Mapping[str, Any]

    @property
    def broken(self) -> tuple[ComparedSignal, ...]:
        """Signals outside their tolerance."""
        return tuple(one for one in self.signals if one.broken_at_s is not None)

    def signal(self, name: str) -> ComparedSignal:
        """A signal by its name in the baseline. Raises Error if it was not compared."""
        for one in self.signals:
            if one.signal == name:
                return one
        raise Error(f"'{name}' was not compared")

    def table(self) -> pandas.DataFrame:
        """The signals as a DataFrame, a row each. Raises Error without pandas."""
        return _table([dataclasses.asdict(one) for one in self.signals], "signal")


def compare(baseline: str | pathlib.Path, other: str | pathlib.Path, *, signals: Sequence[str] = (),
            pairs: Mapping[str, str] | None = None, abs: float | None = None, rel: float | None = None,
            time_s: float | None = None, align: str | None = None, why: bool = False,
            timeout_s: float = 600.0) -> Comparison:
    """Compares two recordings, folders of runs or tables by `rths compare`.

    signals: patterns of names (`*`, `?`); empty: all that both have. pairs: other name by baseline's name.
    abs [SI], rel [share of the magnitude], time_s [s]: the tolerance; without any, nothing is judged.
    align: signal of the baseline whose delay is removed first. why: also a mistake of signals, or a diagnosis.
    Raises Error if they cannot be compared. Signals outside their tolerance are a result: see `Comparison.broken`.
    """
    arguments = ["compare", str(baseline), str(other)]
    for option, value in (("--abs", abs), ("--rel", rel), ("--time-s", time_s), ("--align", align)):
        if value is not None:
            arguments += [option, str(value)]
    if signals:
        arguments += ["--signals", *signals]
    for name, other_name in (pairs or {}).items():
        arguments += ["--pair", f"{name}={other_name}"]
    ended = _ended([*arguments, *["--why"] * why, "--json"], timeout_s)
    numbers = _result_of(ended.stdout)
    if "signals" not in numbers:
        raise Error(ended.stderr.strip().removeprefix("rths: ") or f"rths compare ended with {ended.returncode}")
    return Comparison(tuple((one["key"], one["baseline"], one["other"]) for one in numbers["settings"]),
                      tuple(ComparedSignal(**one) for one in numbers["signals"]), tuple(numbers["only_baseline"]),
                      tuple(numbers["only_other"]), numbers["shift_s"], numbers["judged"], numbers["why"], numbers)

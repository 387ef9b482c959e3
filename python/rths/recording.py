# SPDX-License-Identifier: Apache-2.0
"""Recordings of runs as tables of pandas or xarray, with units."""
from __future__ import annotations

import pathlib
from typing import TYPE_CHECKING, Any

from . import _rths
from .names import matching

if TYPE_CHECKING:
    import numpy
    import pandas

RUN_FILE = "run.h5"


class Recording:
    """The recording of a finished, running or crashed run. All values are in SI."""

    def __init__(self, path: str | pathlib.Path):
        """path: the file, or the folder of a run. Raises Error if there is no recording."""
        path = pathlib.Path(path)
        self.file = path / RUN_FILE if path.is_dir() else path
        self._reader = _rths.Reader(self.file)
        self.signals = list(self._reader.names)  #: full names, in order of offset

    @property
    def time(self) -> numpy.ndarray:
        """Time of each row since the run began [s]."""
        return self._reader.time

    def values(self, signal: str) -> numpy.ndarray:
        """All values of a signal [SI]; NaN: missing. Raises Error with the most similar known name."""
        return self._reader.values(signal)

    def unit(self, signal: str) -> str:
        """Unit of a signal, in SI; "1": a pure number."""
        return self._reader.unit(signal)

    def config(self, file: str) -> str:
        """Text of an input of the run: a file by its name, "overrides" or "model"; empty if the recording has none."""
        return self._reader.config(file)

    @property
    def meta(self) -> dict[str, str]:
        """Time, host, versions, clock and ending of the run."""
        return dict(self._reader.meta)

    @property
    def events(self) -> list[tuple[float, str, float]]:
        """Changes of event signals: time [s], signal, value [SI]."""
        return self._reader.events

    @property
    def drops(self) -> dict[str, int]:
        """Number of steps of each node without a row."""
        return dict(self._reader.drops)

    @property
    def rows_missing(self) -> int:
        """Number of rows that were due while the recorder did not run."""
        return self._reader.rows_missing

    def frame(self, *patterns: str) -> pandas.DataFrame:
        """Signals that match a pattern (`*`, `?`) as a DataFrame, all without a pattern.

        Index: `time` [s]. Columns: signals [SI]. `attrs["units"]`: units by column; `attrs["meta"]`: as `meta`.
        """
        import pandas

        names = self._matching(patterns)
        frame = pandas.DataFrame({name: self.values(name) for name in names},
                                 index=pandas.Index(self.time, name="time"))
        frame.attrs["units"] = {name: self.unit(name) for name in names}
        frame.attrs["meta"] = self.meta
        return frame

    def dataset(self, *patterns: str) -> Any:
        """The same as a Dataset of xarray; each variable has `attrs["units"]`. Raises Error without xarray."""
        try:
            import xarray
        except ImportError:
            raise _rths.Error("a dataset needs xarray, which is not installed; frame() needs pandas only") from None
        variables = {name: ("time", self.values(name), {"units": self.unit(name)}) for name in self._matching(patterns)}
        return xarray.Dataset(variables, {"time": ("time", self.time, {"units": "s"})}, self.meta)

    def _matching(self, patterns: tuple[str, ...]) -> list[str]:
        return matching(self.signals, patterns, str(self.file))


def load(path: str | pathlib.Path, *patterns: str) -> pandas.DataFrame:
    """A recording as a DataFrame, see `Recording.frame`. path: the file, or the folder of a run."""
    return Recording(path).frame(*patterns)

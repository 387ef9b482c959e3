# SPDX-License-Identifier: Apache-2.0
"""Adapters in Python: a class that plays a node of an experiment.

    class Machine(rths.Adapter):
        signals = [rths.Input("xpc.long.displ.ref", "m"), rths.Output("srmd.long.displ.fbk", "m")]

        def step(self, time_s, inputs, outputs):
            outputs[0] = inputs[0]

The experiment names its file: `library = "machine.py"`. It runs in a process of its own.
"""
from __future__ import annotations

import dataclasses
import enum
import gc
import importlib.util
import pathlib
import sys
import tomllib
import traceback
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy


class Status(enum.IntEnum):
    """Result of a step, if it is not None."""

    OK = 0
    DONE = 1  #: finished and at rest: this node may leave the test
    STALE = 2  #: no new input; the last values were held
    LIMIT_EXCEEDED = 3  #: an output was clamped to a limit


@dataclasses.dataclass(frozen=True)
class AdapterSignal:
    """A value that an adapter reads or writes; made by Input, Output, Monitor and Parameter."""

    name: str
    unit: str  #: SI; "1": a pure number
    direction: int
    flags: int = 0
    initial: float = 0.0
    range: tuple[float, float] = (0.0, 0.0)


def Input(name: str, unit: str = "1") -> AdapterSignal:
    """Read from a signal of the map, by its full name [SI]."""
    return AdapterSignal(name, unit, 0)


def Output(name: str, unit: str = "1", *, range: tuple[float, float] = (0.0, 0.0), ramp: bool = False) -> AdapterSignal:
    """Written to a signal of the map. A value outside the range is a fault. ramp: led to 0 when the test stops."""
    return AdapterSignal(name, unit, 1, 2 if ramp else 0, 0.0, range)


def Monitor(name: str, unit: str = "1", *, event: bool = False) -> AdapterSignal:
    """Recorded as monitor.<node>.<name>. event: the recording lists each change."""
    return AdapterSignal(name, unit, 2, 1 if event else 0)


def Parameter(name: str, unit: str, initial: float, range: tuple[float, float] = (0.0, 0.0)) -> AdapterSignal:
    """Read from tune.<node>.<name>: a setting that may change during a run."""
    return AdapterSignal(name, unit, 3, 0, initial, range)


class Adapter:
    """A node of an experiment. The class states `signals`; the map has their names.

    An exception of any function ends the run in order, with its reason and its place.
    """

    signals: Sequence[AdapterSignal] = ()

    def __init__(self, config: Mapping[str, Any]):
        """config: the keys `config.…` of the node."""

    def activate(self) -> None:
        """Takes the initial state. Also called for a restart."""

    def step(self, time_s: float, inputs: numpy.ndarray, outputs: numpy.ndarray) -> Status | None:
        """One period. time_s: scheduled time since the start [s].

        inputs: Inputs and Parameters; outputs: Outputs and Monitors, which keep their values; each in the order of
        `signals` [SI]. Both are valid during the step only.
        """
        raise NotImplementedError(f"{type(self).__name__} has no step")

    def deactivate(self) -> None:
        """Releases the resources of `activate`."""


class _Host:
    """One adapter of a file, for the library that loads it. A failed call returns False and leaves `message`."""

    def __init__(self, config_toml: str):
        given = tomllib.loads(config_toml)
        self._file = pathlib.Path(given["file"])
        self.message = ""
        self.adapter: Adapter | None = None
        self.made = self._tried(lambda: self._make(given.get("config", {})))

    def _make(self, config: Mapping[str, Any]) -> None:
        importlib.import_module("numpy")  # not in the first step
        kind = _class_of(_module_of(self._file), self._file)
        self.adapter = kind(config)
        if not kind.signals:
            raise ValueError(f"{kind.__name__}.signals is empty, expected Input(…), Output(…), …")
        self.signals = [(s.name, s.unit, s.direction, s.flags, float(s.initial), float(s.range[0]), float(s.range[1]))
                        for s in kind.signals]

    def activate(self) -> bool:
        gc.freeze()  # a collection of what exists takes longer than a period
        return self._tried(self.adapter.activate)

    def deactivate(self) -> bool:
        return self._tried(self.adapter.deactivate)

    def step(self, time_s: float, inputs: numpy.ndarray, outputs: numpy.ndarray) -> int:
        """Status of the step; 4: a fault."""
        try:
            status = self.adapter.step(time_s, inputs, outputs)
            return 0 if status is None else int(Status(status))
        except BaseException as error:
            self._note(error)
            return 4

    def _tried(self, call: Any) -> bool:
        try:
            call()
            return True
        except BaseException as error:
            self._note(error)
            return False

    def _note(self, error: BaseException) -> None:
        """One line with the last place in the user's file; the whole traceback goes to standard error."""
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(self._file)]
        if isinstance(error, SyntaxError) and error.filename == str(self._file):
            place = f" ({self._file.name}:{error.lineno})"
        else:
            place = f" ({self._file.name}:{frames[-1].lineno}, in {frames[-1].name})" if frames else ""
        text = error.msg if isinstance(error, SyntaxError) else " ".join(str(error).split())
        self.message = f"{type(error).__name__}: {text}{place}" if text else f"{type(error).__name__}{place}"
        traceback.print_exception(error, file=sys.stderr)


def _module_of(file: pathlib.Path) -> Any:
    if str(file.parent) not in sys.path:
        sys.path.insert(0, str(file.parent))
    specification = importlib.util.spec_from_file_location(f"rths_adapter_{file.stem}", file)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def _class_of(module: Any, file: pathlib.Path) -> type[Adapter]:
    found = [kind for kind in vars(module).values() if isinstance(kind, type) and issubclass(kind, Adapter)
             and kind.__module__ == module.__name__]
    if len(found) != 1:
        names = ", ".join(kind.__name__ for kind in found) or "none"
        raise TypeError(f"{file.name} has {len(found)} classes derived from rths.Adapter ({names}), expected one")
    return found[0]

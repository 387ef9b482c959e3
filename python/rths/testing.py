# SPDX-License-Identifier: Apache-2.0
"""A plugin for pytest: a laboratory of its own for each test.

    def test_the_machine_reaches_its_target(rths_lab):
        lab = rths_lab("my.ringmap.toml")                     # a ring that no other test sees
        lab.start([sys.executable, "machine.py", "{ring}"], node="machine")   # its output is a log
        solver = lab.join("solver")
        solver.write("solver.displacement", 0.1)
        lab.expect_within(1.0, "machine.force", 2.5e5)

Activated by the entry point of an installation by pip, by `-p rths.testing`, or by `pytest_plugins = ["rths.testing"]`
in a conftest.py. After a test, its processes are ended and its ring is removed. Of a failed test the logs and the
recording stay, in the folder that `--rths-keep` names. Tests may run in parallel.
"""
from __future__ import annotations

import contextlib
import dataclasses
import math
import os
import pathlib
import re
import shutil
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest

from . import _rths
from .comparison import Comparison, compare
from .installation import map_file
from .ring import Follower, Node, Ring
from .runs import Run, run

Condition = float | str | Callable[[float], bool]

EVENTUALLY_S = 5.0  #: deadline of `eventually` [s]
LOOK_S = 0.05  #: between looks at the processes [s]


class Laboratory:
    """A ring and the processes on it, for one test. Everything is in `folder`: logs, recording, results of runs."""

    def __init__(self, folder: pathlib.Path, map: str | pathlib.Path, deadline_s: float = 60.0):
        self.folder = folder
        self._engine = _rths.Laboratory(folder, map_file(map), deadline_s)
        self.name = self._engine.name  #: of the ring
        self._nodes: list[Node] = []
        self._end = time.monotonic() + deadline_s
        self.ring = Ring(self._engine.ring, self.name, is_own=False)
        self._observer = self.ring.observe()

    def join(self, node: str, *, plain: bool = False) -> Node:
        """Joins as a node. It leaves when the test ends."""
        self._nodes.append(self.ring.join(node, plain=plain))
        return self._nodes[-1]

    def read(self, signal: str) -> float:
        """Value of a signal [SI]."""
        return self._observer.read(signal)

    def start(self, arguments: Sequence[str | os.PathLike[str]], *, name: str | None = None, node: str | None = None,
              linked: bool = False, ready_s: float = 10.0) -> None:
        """Starts a process. Its output is `<name>.log`.

        arguments: program and arguments; {ring} and {node} are replaced by the names of its ring and its node, which
        are also in its environment as RTHS_RING and RTHS_NODE.
        node: waits until this node is on the ring, at most ready_s [s]; AssertionError otherwise.
        linked: its messages can be dropped, delayed and damaged. It needs the name of its ring from {ring} or RTHS_RING.
        """
        name = name or node or pathlib.Path(arguments[0]).name
        self._engine.start(name, node or "", [os.fspath(word) for word in arguments], linked, ready_s)

    def log(self, name: str) -> str:
        """Output of a process until now."""
        return (self.folder / f"{name}.log").read_text(encoding="utf-8", errors="replace")

    def kill(self, name: str) -> None:
        """Kills a process and its children, and waits until it is gone."""
        self._engine.kill(name)

    def freeze(self, name: str) -> None:
        """Stops a process in its place; `thaw` continues it."""
        self._engine.freeze(name)

    def thaw(self, name: str) -> None:
        self._engine.thaw(name)

    def drop(self, node_or_signal: str) -> None:
        """Drops all writes of a linked node, or those to one of its signals, until `restore`."""
        if node_or_signal in self.ring.signals:
            self._engine.drop_signal(node_or_signal)
        else:
            self._engine.drop(node_or_signal)

    def delay(self, node: str, seconds: float) -> None:
        """Delays the later writes of a linked node [s], until `restore`."""
        self._engine.delay(node, seconds)

    def flip(self, signal: str, bit: int) -> None:
        """Inverts a bit of the longword in each later write of a linked node, until `restore`. Bit 0 is the lowest."""
        self._engine.flip(signal, bit)

    def restore(self, node: str) -> None:
        """Ends the faults of the messages of a linked node."""
        self._engine.restore(node)

    def run(self, experiment: str | pathlib.Path, *, clock: str = "virtual", **options: Any) -> Run:
        """Runs an experiment, see `rths.run`, with results in `folder` and a ring of its own."""
        out = self.folder / f"{pathlib.Path(experiment).stem}_{uuid.uuid4().hex[:6]}"
        return run(experiment, clock=clock, out=out, ring=f"{self.name}_run", **options)

    def expect_baseline(self, baseline: str | pathlib.Path, result: Run | str | pathlib.Path,
                        **options: Any) -> Comparison:
        """Compares a run, a recording or a table with a baseline, see `rths.compare`; equal values without a tolerance.

        AssertionError if a signal is outside its tolerance, or if there is no baseline: it is never made silently.
        """
        made = result.recording().file if isinstance(result, Run) else pathlib.Path(result)
        if not pathlib.Path(baseline).exists():
            kept = f"; if the recording of this test is right, make it: cp {made} {baseline}"
            raise AssertionError(f"baseline {baseline}: does not exist{kept}")
        if not {"abs", "rel", "time_s"} & options.keys():
            options["abs"] = 0
        found = compare(baseline, made, **options)
        if found.broken:
            first = found.broken[0]
            raise AssertionError(f"baseline {baseline}: {len(found.broken)} of {len(found.signals)} signals are outside "
                                 f"their tolerance, first {first.signal} at {first.broken_at_s:g} s")
        return found

    def expect_within(self, seconds: float, signal: str, condition: Condition, tolerance: float | None = None) -> float:
        """Waits until a signal meets a condition, now or by one of the writes within the time [s]; returns its value.

        condition: a value [SI], met to 1e-6 of it or to the tolerance [SI]; the name of one of the signal's values; or
        a function of the value. No write is missed, however short the value lasts.
        AssertionError if the condition is not met in time, or if a process failed that was not killed.
        """
        met = self._condition(signal, condition, tolerance)
        follower = self.ring.follow(signal)
        last = self.read(signal)
        if met(last):
            return last
        for value in self._values_within(follower, signal, seconds):
            if met(value):
                return value
            last = value
        self._engine.check_programs()
        raise AssertionError(f"{signal}: expected {self._text(signal, condition, tolerance)} within {seconds:g} s, "
                             f"last value {self._quantity(signal, last)}")

    def eventually(self, signal: str, condition: Condition, tolerance: float | None = None) -> float:
        """As `expect_within`, with a deadline of 5 s."""
        return self.expect_within(EVENTUALLY_S, signal, condition, tolerance)

    def never(self, seconds: float, signal: str, condition: Condition, tolerance: float | None = None) -> None:
        """Follows a signal for a time [s]. AssertionError as soon as it meets the condition, now or by a write."""
        met = self._condition(signal, condition, tolerance)
        follower = self.ring.follow(signal)
        begun = time.monotonic()
        values = [self.read(signal)]
        for value in values if met(values[0]) else self._values_within(follower, signal, seconds):
            if met(value):
                raise AssertionError(f"{signal}: expected never {self._text(signal, condition, tolerance)}, found "
                                     f"{self._quantity(signal, value)} after {time.monotonic() - begun:.3f} s")
        self._engine.check_programs()

    def check_owners(self) -> None:
        """Judges the stores of the last moment, too; the fixture calls it at the end of a test.

        AssertionError if a word was stored by another process than its owner.
        """
        self._engine.check_owners()

    def close(self, *, keep: bool = False) -> None:
        """Ends all processes and removes the ring. The folder stays; with `keep`, it gets the recording of all writes."""
        with contextlib.ExitStack() as stack:
            stack.callback(self._engine.keep if keep else self._engine.close)
            stack.callback(self.ring.close)
            stack.callback(self._observer.leave)
            for node in self._nodes:
                stack.callback(node.leave)

    def _condition(self, signal: str, condition: Condition, tolerance: float | None) -> Callable[[float], bool]:
        known = self.ring.signals[self.ring.matching(signal)[0]]
        if callable(condition):
            return condition
        if isinstance(condition, str) and condition not in known.values:
            raise _rths.Error(f"{signal}: has no value '{condition}', expected one of: {', '.join(known.values)}")
        expected = known.values[condition] if isinstance(condition, str) else float(condition)
        relative, absolute = (1e-6, 1e-12) if tolerance is None else (0.0, tolerance)
        return lambda value: math.isclose(value, expected, rel_tol=relative, abs_tol=absolute)

    def _text(self, signal: str, condition: Condition, tolerance: float | None) -> str:
        if callable(condition):
            return f"that {getattr(condition, '__name__', 'the condition')} holds"
        text = condition if isinstance(condition, str) else self._quantity(signal, condition)
        return text if tolerance is None else f"{text} ± {tolerance:g}"

    def _quantity(self, signal: str, value: float) -> str:
        unit = self.ring.signals[signal].unit
        return f"{value:.7g}" if unit == "1" else f"{value:.7g} {unit}"

    def _values_within(self, follower: Follower, signal: str, seconds: float) -> Iterator[float]:
        deadline = min(time.monotonic() + seconds, self._end)
        while (left_s := deadline - time.monotonic()) > 0:
            write = follower.wait(min(left_s, LOOK_S))
            if write is None:
                self._engine.check_programs()
            else:
                yield write.values[signal]


@dataclasses.dataclass
class _Kept:
    """Laboratories of a test, and the folder of all their files."""

    folder: pathlib.Path
    laboratories: list[Laboratory] = dataclasses.field(default_factory=list)

    def close(self, keep: bool) -> None:
        with contextlib.ExitStack() as stack:
            for laboratory in self.laboratories:
                stack.callback(laboratory.close, keep=keep)


def _make_folder(folder: pathlib.Path) -> None:
    """Makes a folder, although tests beside this one remove empty folders above it."""
    for _ in range(_MOST_RIVALS):
        with contextlib.suppress(FileNotFoundError):
            return folder.mkdir(parents=True)
    return folder.mkdir(parents=True)


_MOST_RIVALS = 100
_KEPT = pytest.StashKey[_Kept]()
_FAILED = pytest.StashKey[bool]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("rths").addoption("--rths-keep", metavar="DIR", default="out/failed_tests",
                                      help="folder for logs and recordings of failed tests [out/failed_tests]")


@pytest.hookimpl(trylast=True)
def pytest_runtest_call(item: pytest.Item) -> None:
    """After a test that passed: a foreign store fails it."""
    kept = item.stash.get(_KEPT, None)
    for laboratory in kept.laboratories if kept is not None else []:
        laboratory.check_owners()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report = (yield).get_result()
    if report.failed:
        item.stash[_FAILED] = True
    kept = item.stash.get(_KEPT, None)
    if kept is not None and report.failed and report.when == "call":
        report.sections.append(("rths", f"logs and recording: {kept.folder}"))


@pytest.fixture
def rths_lab(request: pytest.FixtureRequest) -> Iterator[Callable[[str | pathlib.Path], Laboratory]]:
    """Function that makes a Laboratory with a map: the name of a built-in map, or a file. Cleaned up after the test."""
    parent = pathlib.Path(request.config.getoption("--rths-keep")).absolute()
    test = re.sub(r"[^\w.-]+", "_", request.node.name)[:80]
    kept = _Kept(parent / f"{test}_{os.getpid()}_{uuid.uuid4().hex[:6]}")
    request.node.stash[_KEPT] = kept

    def make(map: str | pathlib.Path, deadline_s: float = 60.0) -> Laboratory:
        count = len(kept.laboratories)
        folder = kept.folder if count == 0 else kept.folder / f"laboratory_{count + 1}"
        _make_folder(folder)
        kept.laboratories.append(Laboratory(folder, map, deadline_s))
        return kept.laboratories[-1]

    try:
        yield make
    finally:
        failed = request.node.stash.get(_FAILED, False)
        kept.close(keep=failed)
        if not failed:
            shutil.rmtree(kept.folder, ignore_errors=True)
            with contextlib.suppress(OSError):
                parent.rmdir()  # if it is empty
                if parent.parts[-2:] == ("out", "failed_tests"):
                    parent.parent.rmdir()

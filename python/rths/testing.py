# SPDX-License-Identifier: Apache-2.0
"""A plugin for pytest: a laboratory of its own for each test.

    def test_the_machine_reaches_its_target(rths_lab):
        lab = rths_lab("my.ringmap.toml")                     # a ring that no other test sees
        lab.start([sys.executable, "machine.py", lab.name])   # a process; its output is a log
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
import signal
import subprocess
import threading
import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import pytest

from . import _rths
from .runs import Run, run
from .ring import Follower, Node, Ring, Write, create_ring

Condition = float | str | Callable[[float], bool]

EVENTUALLY_S = 5.0  #: deadline of `eventually` [s]
END_S = 2.0  #: a process may take to end after SIGTERM [s]
RECORDING_FILE = "run.h5"


class Laboratory:
    """A ring and the processes on it, for one test. Everything is in `folder`: logs, recording, results of runs."""

    def __init__(self, folder: pathlib.Path, map: str | pathlib.Path):
        self.folder = folder
        self.name = f"test_{os.getpid()}_{uuid.uuid4().hex[:12]}"  #: of the ring
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._nodes: list[Node] = []
        self.ring: Ring = create_ring(self.name, map)
        try:
            self._observer = self.ring.observe()
            self._recorder = _Recorder(self.ring, folder / RECORDING_FILE)
        except BaseException:
            self.ring.close()
            raise

    def join(self, node: str, *, plain: bool = False) -> Node:
        """Joins as a node. It leaves when the test ends."""
        self._nodes.append(self.ring.join(node, plain=plain))
        return self._nodes[-1]

    def read(self, signal: str) -> float:
        """Value of a signal [SI]."""
        return self._observer.read(signal)

    def start(self, arguments: Sequence[str | os.PathLike[str]], *, name: str | None = None, node: str | None = None,
              environment: Mapping[str, str] | None = None, ready_s: float = 10.0) -> subprocess.Popen[bytes]:
        """Starts a process. Its output is `<name>.log`; the variable RTHS_RING holds the name of the ring.

        node: waits until this node is on the ring, at most ready_s [s]; AssertionError otherwise.
        """
        name = name or pathlib.Path(arguments[0]).name
        if name in self._processes:
            raise _rths.Error(f"the process '{name}' was started before, expected another name")
        with open(self.folder / f"{name}.log", "wb") as log:
            process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                       env={**os.environ, "RTHS_RING": self.name, **(environment or {})},
                                       start_new_session=True)
        self._processes[name] = process
        if node is not None:
            self._wait_for_node(node, name, process, ready_s)
        return process

    def log(self, name: str) -> str:
        """Output of a process until now."""
        return (self.folder / f"{name}.log").read_text(encoding="utf-8", errors="replace")

    def kill(self, name: str) -> None:
        """Kills a process and its children, and waits until it is gone."""
        self._signal(name, signal.SIGKILL)
        self._processes[name].wait(END_S)

    def freeze(self, name: str) -> None:
        """Stops a process in its place; `thaw` continues it."""
        self._signal(name, signal.SIGSTOP)

    def thaw(self, name: str) -> None:
        self._signal(name, signal.SIGCONT)

    def run(self, experiment: str | pathlib.Path, *, clock: str = "virtual", **options: Any) -> Run:
        """Runs an experiment, see `rths.run`, with results in `folder` and a ring of its own."""
        out = self.folder / f"{pathlib.Path(experiment).stem}_{uuid.uuid4().hex[:6]}"
        return run(experiment, clock=clock, out=out, ring=f"{self.name}_run", **options)

    def expect_within(self, seconds: float, signal: str, condition: Condition) -> float:
        """Waits until a signal meets a condition, now or by one of the writes within the time [s]; returns its value.

        condition: a value [SI], met to 1e-6 of it; the name of one of the signal's values; or a function of the value.
        No write is missed, however short the value lasts. AssertionError if the condition is not met in time.
        """
        met = self._condition(signal, condition)
        follower = self.ring.follow(signal)
        last = self.read(signal)
        if met(last):
            return last
        for value in _values_within(follower, signal, seconds):
            if met(value):
                return value
            last = value
        raise AssertionError(f"{signal}: expected {self._text(signal, condition)} within {seconds:g} s, "
                             f"last value {self._quantity(signal, last)}")

    def eventually(self, signal: str, condition: Condition) -> float:
        """As `expect_within`, with a deadline of 5 s."""
        return self.expect_within(EVENTUALLY_S, signal, condition)

    def never(self, seconds: float, signal: str, condition: Condition) -> None:
        """Follows a signal for a time [s]. AssertionError as soon as it meets the condition, now or by a write."""
        met = self._condition(signal, condition)
        follower = self.ring.follow(signal)
        begun = time.monotonic()
        values = [self.read(signal)]
        for value in values if met(values[0]) else _values_within(follower, signal, seconds):
            if met(value):
                raise AssertionError(f"{signal}: expected never {self._text(signal, condition)}, found "
                                     f"{self._quantity(signal, value)} after {time.monotonic() - begun:.3f} s")

    def close(self) -> None:
        """Ends all processes, leaves and removes the ring, and closes the recording. The folder stays."""
        with contextlib.ExitStack() as stack:
            stack.callback(self.ring.close)
            stack.callback(self._observer.leave)
            for node in self._nodes:
                stack.callback(node.leave)
            stack.callback(self._recorder.close)
            stack.callback(self._end_processes)

    def _condition(self, signal: str, condition: Condition) -> Callable[[float], bool]:
        known = self.ring.signals[self.ring.matching(signal)[0]]
        if callable(condition):
            return condition
        if isinstance(condition, str) and condition not in known.values:
            raise _rths.Error(f"{signal}: has no value '{condition}', expected one of: {', '.join(known.values)}")
        expected = known.values[condition] if isinstance(condition, str) else float(condition)
        return lambda value: math.isclose(value, expected, rel_tol=1e-6, abs_tol=1e-12)

    def _text(self, signal: str, condition: Condition) -> str:
        if callable(condition):
            return f"that {getattr(condition, '__name__', 'the condition')} holds"
        return condition if isinstance(condition, str) else self._quantity(signal, condition)

    def _quantity(self, signal: str, value: float) -> str:
        unit = self.ring.signals[signal].unit
        return f"{value:.7g}" if unit == "1" else f"{value:.7g} {unit}"

    def _wait_for_node(self, node: str, name: str, process: subprocess.Popen[bytes], ready_s: float) -> None:
        deadline = time.monotonic() + ready_s
        while not self._observer.wait_for_node(node, 0.01):
            if process.poll() is not None:
                raise AssertionError(f"the process '{name}' ended with {process.returncode} before node '{node}' was on "
                                     f"the ring; it said:\n{self.log(name)}")
            if time.monotonic() >= deadline:
                raise AssertionError(f"node '{node}' of process '{name}' was not on the ring within {ready_s:g} s")

    def _signal(self, name: str, number: signal.Signals) -> None:
        if name not in self._processes:
            raise _rths.Error(f"there is no process '{name}', expected one of: {', '.join(self._processes)}")
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._processes[name].pid, number)

    def _end_processes(self) -> None:
        for name in self._processes:
            self._signal(name, signal.SIGCONT)
            self._signal(name, signal.SIGTERM)
        deadline = time.monotonic() + END_S
        for name, process in self._processes.items():
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(max(0.0, deadline - time.monotonic()))
            self._signal(name, signal.SIGKILL)  # also its children
            process.wait(END_S)


def _values_within(follower: Follower, signal: str, seconds: float) -> Iterator[float]:
    deadline = time.monotonic() + seconds
    while (left_s := deadline - time.monotonic()) > 0:
        write = follower.wait(left_s)
        if write is not None:
            yield write.values[signal]


class _Recorder:
    """Records every write to the ring in a thread of its own: a row for each, all signals [SI]."""

    PERIOD_S = 0.02  #: longest wait before it looks whether it is to end

    def __init__(self, ring: Ring, file: pathlib.Path):
        names = list(ring.signals)
        self._follower = ring.follow()
        with ring.observe() as observer:
            self._row = observer.read_all()
        self._writer = _rths.Writer(file, ring._open(), names, [("made_by", "rths.testing")])
        self._begun = time.monotonic()
        self._end = math.inf
        self._ends = threading.Event()
        self._writer.append(0.0, list(self._row.values()))
        self._thread = threading.Thread(target=self._record, name="rths recorder", daemon=True)
        self._thread.start()

    def _record(self) -> None:
        last_s = 0.0
        while (write := self._next()) is not None or not self._ends.is_set():
            if write is None:
                continue
            self._row.update(write.values)
            last_s = max(time.monotonic() - self._begun, last_s + 1e-9)
            self._writer.append(last_s, list(self._row.values()))

    def _next(self) -> Write | None:
        """The next write. After the end: one that is there already, and for a bounded time."""
        if self._ends.is_set() and time.monotonic() > self._end:
            return None
        try:
            return self._follower.wait(0.0 if self._ends.is_set() else self.PERIOD_S)
        except _rths.LostWrites:
            return self._next()

    def close(self) -> None:
        self._end = time.monotonic() + END_S / 2
        self._ends.set()
        self._thread.join()
        self._writer.close()


@dataclasses.dataclass
class _Kept:
    """Laboratories of a test, and the folder of all their files."""

    folder: pathlib.Path
    laboratories: list[Laboratory] = dataclasses.field(default_factory=list)

    def close(self) -> None:
        with contextlib.ExitStack() as stack:
            for laboratory in self.laboratories:
                stack.callback(laboratory.close)


_KEPT = pytest.StashKey[_Kept]()
_FAILED = pytest.StashKey[bool]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("rths").addoption("--rths-keep", metavar="DIR", default="out/failed_tests",
                                      help="folder for logs and recordings of failed tests [out/failed_tests]")


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

    def make(map: str | pathlib.Path) -> Laboratory:
        count = len(kept.laboratories)
        folder = kept.folder if count == 0 else kept.folder / f"laboratory_{count + 1}"
        folder.mkdir(parents=True)
        kept.laboratories.append(Laboratory(folder, map))
        return kept.laboratories[-1]

    try:
        yield make
    finally:
        kept.close()
        if not request.node.stash.get(_FAILED, False):
            shutil.rmtree(kept.folder, ignore_errors=True)
            with contextlib.suppress(OSError):
                parent.rmdir()  # if it is empty

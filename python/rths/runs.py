# SPDX-License-Identifier: Apache-2.0
"""Runs and diagnoses, by the installed command as a child process with a deadline.

A test in real time owns its process: its signals, its scheduling and its memory. So the command runs it, and tells its
result as JSON.
"""
from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import pathlib
import signal
import subprocess
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._rths import Error
from .installation import command
from .recording import Recording

if TYPE_CHECKING:
    import pandas

_GRACE_S = 10.0  #: of a command that was asked to stop


@dataclasses.dataclass(frozen=True)
class Cause:
    """A term that the simulation left out."""

    name: str
    title: str
    part: str  #: "numerical", "actuator", "machine", "bearing", "structure" or "sensor"
    confidence: float  #: 0 to 1
    explained_fraction: float | None  #: of the error's energy beyond the noise, 0 to 1; None: coarse steps of a sensor
    parameters: Mapping[str, Mapping[str, Any]]  #: by name: "value", "ci95" and "unit"


@dataclasses.dataclass(frozen=True)
class Verdict:
    """The verdict of a diagnosis. `numbers` holds all of verdict.json, which docs/verdict.md describes."""

    kind: str  #: "missing", "none" or "unknown"
    headline: str  #: the verdict in at most 25 words
    sentence: str  #: in full
    confidence: float  #: 0 to 1
    causes: tuple[Cause, ...]  #: the most important first
    numbers: Mapping[str, Any]
    folder: pathlib.Path

    @classmethod
    def read(cls, folder: str | pathlib.Path) -> Verdict:
        """Reads the verdict in the folder of a diagnosis or a run. Raises Error if there is none."""
        folder = pathlib.Path(folder)
        numbers = _read_json(folder / "verdict.json")
        if numbers is None:
            raise Error(f"{folder / 'verdict.json'}: does not exist, expected the folder of a diagnosis")
        fields = [field.name for field in dataclasses.fields(Cause)]
        causes = tuple(Cause(**{name: cause[name] for name in fields}) for cause in numbers["causes"])
        return cls(numbers["verdict"], numbers.get("headline", numbers["sentence"]), numbers["sentence"], numbers["confidence"], causes, numbers, folder)


@dataclasses.dataclass(frozen=True)
class Run:
    """The result of a run."""

    exit_code: int  #: 0: completed and conclusive; 1: not conclusive, or interrupted; 2: failed
    folder: pathlib.Path | None  #: None: it did not start, or it has no recorder and no `out`
    report: Mapping[str, Any] | None  #: report.json, which docs/experiments.md describes; None: no report
    stdout: str  #: one JSON document
    stderr: str

    @property
    def trouble(self) -> str:
        """Lines in which the command says why it failed; empty if it did not."""
        return "\n".join(line for line in self.stderr.splitlines() if line.startswith("rths: ")) if self.exit_code else ""

    def recording(self) -> Recording:
        """The recording of the run. Raises Error if there is none."""
        return Recording(self._folder())

    def figures(self) -> pandas.DataFrame:
        """The figures of `report` as a DataFrame: a row for each axis, a column for each number.

        Raises Error if there is no report, or without pandas.
        """
        if self.report is None:
            raise Error(f"the run has no report: {self.trouble or 'it has no recording'}")
        rows = [{"axis": axis, **{key: value for key, value in figures.items() if not isinstance(value, (list, dict))}}
                for axis, figures in self.report["axes"].items()]
        return _table(rows, "axis")

    def verdict(self) -> Verdict:
        """The diagnosis that ended the run. Raises Error if there was none."""
        return Verdict.read(self._folder())

    def _folder(self) -> pathlib.Path:
        if self.folder is None:
            raise Error(f"the run has no recording: {self.trouble or 'its experiment has no recorder'}")
        return self.folder


def run(experiment: str | pathlib.Path, *, set: Mapping[str, Any] | None = None, out: str | pathlib.Path | None = None,
        force: bool = False, clock: str = "wall", ring: str | None = None, diagnosis: bool = True,
        timeout_s: float = 600.0) -> Run:
    """Runs an experiment by `rths run` and waits for its end.

    set: keys to override, `{"duration_s": 12, "axes": ["long"]}`. out: folder of the results; None: a new one.
    force: replaces the results of an earlier run in `out`. clock: "wall" or "virtual". ring: name of its ring.
    diagnosis: diagnoses the recording of an experiment with a second earthquake.
    timeout_s: deadline of the whole command [s]. Then the run is stopped in order, and Error is raised.
    A failed run is a result: see `Run.exit_code` and `Run.trouble`.
    """
    arguments = ["run", str(experiment), "--clock", clock]
    for key, value in (set or {}).items():
        arguments += ["--set", f"{key}={_toml(value)}"]
    if out is not None:
        arguments += ["--out", str(out)] + ["--force"] * force
    elif force:
        raise Error("force is True without a folder of results, expected out=…")
    if ring is not None:
        arguments += ["--ring", ring]
    if not diagnosis:
        arguments.append("--no-diagnosis")
    ended = _ended([*arguments, "--json"], timeout_s)
    folder = _folder_of(_result_of(ended.stdout), out)
    report = None if folder is None else _read_json(folder / "report.json")
    return Run(ended.returncode, folder, report, ended.stdout, ended.stderr)


def diagnose(case: str | pathlib.Path, *, out: str | pathlib.Path | None = None, without: Sequence[str] = (),
             seed: int = 1, timeout_s: float = 600.0) -> Verdict:
    """Diagnoses a case or a run by `rths diagnose`, and returns its verdict.

    case: folder with a case.toml, a case file, or the folder or recording of a run. out: folder of the results.
    without: terms that may not be named. seed: of noise draws. timeout_s: deadline of the whole command [s].
    Raises Error if the case cannot be read, or at the deadline.
    """
    arguments = ["diagnose", str(case), "--seed", str(seed)]
    if out is not None:
        arguments += ["--out", str(out)]
    if without:
        arguments += ["--without", ",".join(without)]
    ended = _ended([*arguments, "--json"], timeout_s)
    result = _result_of(ended.stdout)
    if ended.returncode != 0 or "numbers" not in result:
        raise Error(ended.stderr.strip().removeprefix("rths: ") or f"rths diagnose ended with {ended.returncode}")
    return Verdict.read(pathlib.Path(result["numbers"]).parent)


def _table(rows: list[dict[str, Any]], index: str) -> pandas.DataFrame:
    try:
        import pandas
    except ImportError:
        raise Error("a table needs pandas, which is not installed") from None
    return pandas.DataFrame(rows).set_index(index)


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, pathlib.Path)):
        return json.dumps(str(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    raise Error(f"set: found a value of type {type(value).__name__}, expected a number, text, bool, list or dict")


def _ended(arguments: list[str], timeout_s: float) -> subprocess.CompletedProcess[str]:
    """Runs the command; at the deadline, or if this program is interrupted, stops it in order."""
    process = subprocess.Popen([command(), *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace",
                               start_new_session=True)
    try:
        stdout, stderr = process.communicate(timeout=timeout_s)
    except subprocess.TimeoutExpired:
        raise Error(f"rths {arguments[0]} {arguments[1]}: did not end within {timeout_s:g} s and was stopped") from None
    finally:
        _stop(process)
    return subprocess.CompletedProcess(arguments, process.returncode, stdout, stderr)


def _stop(process: subprocess.Popen[str]) -> None:
    """Interrupts the command, which stops its nodes in order; kills what remains after the grace."""
    if process.poll() is not None:
        return
    process.send_signal(signal.SIGINT)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.communicate(timeout=_GRACE_S)
        return
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def _result_of(stdout: str) -> Mapping[str, Any]:
    """The result that the command wrote; empty if it failed before."""
    with contextlib.suppress(json.JSONDecodeError):
        return json.loads(stdout)
    return {}


def _folder_of(result: Mapping[str, Any], out: str | pathlib.Path | None) -> pathlib.Path | None:
    """The folder of a run that has begun: the named one, or that of its recording."""
    if result.get("folder") is None:
        return None
    if out is not None:
        return pathlib.Path(out)
    return None if result["recording"] is None else pathlib.Path(result["recording"]).parent


def _read_json(file: pathlib.Path) -> Any:
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else None

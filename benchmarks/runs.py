"""Runs of the command rths."""
import json
import pathlib
import subprocess
import tempfile

from results_file import TREE


def run(rths, experiment, folder, *options, clock="virtual", may_end_early=False):
    """Runs an example, or the experiment of a path, into a folder. @returns its report.json

    A test that is not conclusive is no error, nor is one that ends early, if it may and has a report.
    """
    finished = subprocess.run([rths, "run", str(TREE / "examples" / experiment), "--clock", clock, "--out", str(folder),
                               *options], stdout=subprocess.DEVNULL)
    report = pathlib.Path(folder) / "report.json"
    if finished.returncode > 1 and not (may_end_early and report.exists()):  # 1: not conclusive
        finished.check_returncode()
    return json.loads(report.read_text())


def report_of(rths, experiment, *options, **how):
    """The report of a run whose folder is removed."""
    with tempfile.TemporaryDirectory() as folder:
        return run(rths, experiment, folder, *options, **how)

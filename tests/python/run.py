#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a file of tests by pytest. Exits with 77, which ctest counts as skipped, if none of them ran."""
import importlib.util
import pathlib
import sys

missing = [name for name in ("numpy", "pandas", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print(f"SKIPPED: the tests of the Python package need {', '.join(missing)}")
    sys.exit(77)

import pytest


class Results:
    """Counts the tests that ran, and keeps the reasons of the others."""

    def __init__(self):
        self.count, self.reasons = 0, set()

    def pytest_runtest_logreport(self, report):
        if report.skipped:
            self.reasons.add(report.longrepr[2].removeprefix("Skipped: "))
        elif report.when == "call":
            self.count += 1


FOLDER = pathlib.Path(__file__).resolve().parent
results = Results()
status = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "-p", "rths.testing", f"--rootdir={FOLDER}", "--durations=3",
                      *(str(FOLDER / name) for name in sys.argv[1:])], plugins=[results])
if status == pytest.ExitCode.OK and results.count == 0 and results.reasons:
    print(f"SKIPPED: {', '.join(results.reasons)}")
    sys.exit(77)
sys.exit(status)

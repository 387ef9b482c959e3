#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a file of tests by pytest. Exits with 77, which ctest counts as skipped, if a package of Python is missing."""
import importlib.util
import pathlib
import sys

missing = [name for name in ("numpy", "pandas", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print(f"SKIPPED: the tests of the Python package need {', '.join(missing)}")
    sys.exit(77)

import pytest

FOLDER = pathlib.Path(__file__).resolve().parent
sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "-p", "rths.testing", f"--rootdir={FOLDER}", "--durations=3",
                      *(str(FOLDER / name) for name in sys.argv[1:])]))

# SPDX-License-Identifier: Apache-2.0
"""The installation of the package by CMake; numpy_test.py has those by pip."""
import os
import subprocess
import sys

from conftest import TREE, TWO_SIGNALS

PROGRAM = """
import sys, rths
with rths.in_process_ring(sys.argv[1]) as ring:
    ring.join("machine").write("machine.force", 2e3)
    print(rths.__file__, ring.observe().read("machine.force"))
"""


def run(arguments, **variables):
    result = subprocess.run(arguments, capture_output=True, text=True, timeout=110, env={**os.environ, **variables})
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def check_import(folder):
    printed = run([sys.executable, "-c", PROGRAM, TWO_SIGNALS], PYTHONPATH=str(folder))
    assert printed == f"{folder}/rths/__init__.py 2000.0\n"


def test_cmake_installs_the_package(tmp_path):
    build = os.environ["RTHS_BUILD"]

    run(["cmake", "--install", f"{build}/python", "--prefix", tmp_path])

    (package,) = tmp_path.glob("lib/python3.*/site-packages/rths")
    check_import(package.parent)
    assert {"py.typed", "_rths.pyi", "testing.py"} <= {file.name for file in package.iterdir()}
    assert not (package / "CMakeLists.txt").exists()

# SPDX-License-Identifier: Apache-2.0
"""The package with an old and with a new NumPy: the same extension, and installations by pip without a network."""
import os
import re
import subprocess
import sys
import sysconfig

import pytest
from conftest import TREE

FOLDER = TREE / "tests/python"
BUILD = os.environ["RTHS_BUILD"]
PACKAGE = f"{BUILD}/python"
ENVIRONMENTS = sorted(made.parent for made in (TREE / "build/python").glob("numpy-*/made"))
pytestmark = pytest.mark.skipif(len(ENVIRONMENTS) < 2, reason="needs the environments of Python with NumPy 1.26 and 2, "
                                                              "which ./lab test installs from PyPI")

# Compiles nothing, so that a build takes no time: notes when it begins and ends with each source of the package.
COMPILER = """#!/bin/sh
case "$*" in
*/python/src/*)
  echo begin >>"$NOTES"; sleep 0.3; echo end >>"$NOTES"
  while [ "$1" != -o ]; do shift; done
  touch "$2" ;;
*) exec g++ "$@" ;;
esac
"""


def run(arguments, timeout_s=200, **variables):
    result = subprocess.run([str(word) for word in arguments], capture_output=True, text=True, timeout=timeout_s,
                            env={**os.environ, **variables})
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def python_of(environment):
    return environment / "bin/python"


def variables_of(environment, package=PACKAGE):
    """Also a host of adapters, which embeds the interpreter of the system, takes the packages of the environment."""
    (site,) = environment.glob("lib/python3.*/site-packages")
    return {"PYTHONPATH": f"{package}:{site}", "PATH": f"{environment}/bin:{os.environ['PATH']}"}


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """An installation of rths without the Python package."""
    folder = tmp_path_factory.mktemp("prefix")
    run(["cmake", "--install", BUILD, "--prefix", folder])
    return folder


def install(environment, target, prefix, *options, **variables):
    run([python_of(environment), "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "--target",
         target, "--config-settings", f"build-dir={target}.build", *options, TREE / "python"], CMAKE_PREFIX_PATH=str(prefix), **variables)


def test_every_function_gives_the_same_with_both(tmp_path):
    found = []
    for environment in ENVIRONMENTS[0], ENVIRONMENTS[-1]:
        folder = tmp_path / environment.name
        folder.mkdir()
        text = run([python_of(environment), FOLDER / "every_function.py", folder, "--adapters"], **variables_of(environment))
        found.append(text.replace(environment.name, "NUMPY").splitlines())

    assert len(found[0]) > 100
    assert found[0] == found[1]


@pytest.mark.parametrize("environment", ENVIRONMENTS, ids=lambda environment: environment.name)
def test_arrays_have_the_values_that_were_written(environment):
    printed = run([python_of(environment), "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "rths.testing",
                   f"--rootdir={FOLDER}", FOLDER / "recording_test.py", FOLDER / "ring_test.py"], **variables_of(environment))
    assert re.search(r"^\d+ passed", printed, re.MULTILINE)


def test_pip_installs_with_the_libraries_within_a_minute(tmp_path, prefix):
    target = tmp_path / "installed"
    before = os.times()

    install(ENVIRONMENTS[-1], target, prefix, CMAKE_BUILD_PARALLEL_LEVEL="1")

    after = os.times()
    assert after.children_user + after.children_system - before.children_user - before.children_system < 60  # processor
    (folder := tmp_path / "files").mkdir()
    run([python_of(ENVIRONMENTS[-1]), FOLDER / "every_function.py", folder], **variables_of(ENVIRONMENTS[-1], target))
    plugin = run([python_of(ENVIRONMENTS[-1]), "-m", "pytest", "--help"], **variables_of(ENVIRONMENTS[-1], target))
    assert "--rths-keep" in plugin
    assert {"py.typed", "_rths.pyi", "__init__.py", f"_rths{sysconfig.get_config_var('EXT_SUFFIX')}"} <= {
        file.name for file in (target / "rths").iterdir()}


@pytest.mark.parametrize("asked, options", [({"CMAKE_BUILD_PARALLEL_LEVEL": "1"}, []), ({"MAKEFLAGS": "-j1"}, []),
                                            ({}, ["--config-settings", "build.tool-args=-j1"])])
def test_pip_runs_no_more_jobs_than_asked(tmp_path, prefix, asked, options):
    compiler, notes = tmp_path / "g++", tmp_path / "notes"
    compiler.write_text(COMPILER)
    compiler.chmod(0o755)

    install(ENVIRONMENTS[-1], tmp_path / "installed", prefix, "--config-settings", "cmake.define.CMAKE_UNITY_BUILD=OFF",
            "--config-settings", f"cmake.define.CMAKE_CXX_COMPILER={compiler}", *options, NOTES=str(notes), **asked)

    assert notes.read_text().split() == ["begin", "end"] * 6  # five sources, and the linker

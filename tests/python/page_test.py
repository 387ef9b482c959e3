# SPDX-License-Identifier: Apache-2.0
"""Executes the blocks of docs/python.md in their order, from the text of the page."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys

import pytest
from conftest import TREE

PAGE = TREE / "docs/python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
BLOCKS = [(PAGE.read_text()[:match.start(1)].count("\n"), match[1]) for match in BLOCK.finditer(PAGE.read_text())]


@pytest.fixture(scope="module")
def names():
    """Names that the blocks share."""
    return {"__name__": "page"}


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    """The folder of the page, with the examples."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "examples").symlink_to(TREE / "examples")
    before = pathlib.Path.cwd()
    os.chdir(folder)
    yield folder
    os.chdir(before)


def skip_if_something_is_missing(block):
    if "matplotlib" in block and importlib.util.find_spec("matplotlib") is None:
        pytest.skip("matplotlib is not installed")
    if "rths.diagnose" in block and not os.environ.get("RTHS_LONG"):
        pytest.skip("a diagnosis of an example takes some seconds: RTHS_LONG=1 runs it")


@pytest.mark.parametrize("line, block", BLOCKS, ids=[f"line_{line + 1}" for line, _ in BLOCKS])
def test_the_block_works(line, block, names, folder):
    skip_if_something_is_missing(block)
    if file := re.match(r"# (test_\w+\.py)\n", block):
        (folder / file[1]).write_text(block)
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "rths.testing", file[1]]
        result = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert result.returncode == 0, result.stdout + result.stderr
        return
    exec(compile("\n" * line + block, str(PAGE), "exec"), names)


def test_the_page_shows_the_loop_of_the_example():
    shown = re.search(r"^    with rths\.attach.*?beat\(\)\n", PAGE.read_text(), re.MULTILINE | re.DOTALL)[0]
    source = (TREE / "examples/python/spring_machine.py").read_text()
    assert shown in re.sub(r"  # before it joins.*", "", source)

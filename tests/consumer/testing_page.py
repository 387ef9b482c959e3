#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Executes docs/testing.md from its own text, with the installed package.

    testing_page.py PREFIX FOLDER [--times N]

The commands run in FOLDER, in the order of the page; each line of its output blocks must be printed. Blocks of code must
be part of the installed example. --times: then repeats all tests of the example N times with ctest -j8, beside a canary.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs/testing.md"
EXAMPLE = "share/rths/examples/testing"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)


def check_excerpts(prefix):
    """Names the code of the page that is not in the example."""
    sources = [file.read_text() for file in (prefix / EXAMPLE).iterdir() if file.is_file()]
    for language in ("cpp", "python", "cmake"):
        for block in blocks(language):
            if not any(block in source for source in sources):
                sys.exit(f"{PAGE}: this block is not in the example:\n{block}")


def environment(prefix):
    (site,) = prefix.glob("lib/python3.*/site-packages")
    return {**os.environ, "PATH": f"{prefix}/bin:{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}",
            "PYTHONPATH": str(site), "PREFIX": str(prefix),
            "CMAKE_PREFIX_PATH": str(prefix), "CMAKE_GENERATOR": "Ninja", "PYTHONDONTWRITEBYTECODE": "1"}


def run_page(prefix, folder):
    script = "set -e\n" + "\n".join(blocks("sh"))
    ran = subprocess.run(["bash", "-c", script], cwd=folder, env=environment(prefix), capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{PAGE}: its commands failed:\n{ran.stdout}{ran.stderr}")
    for block in blocks("text"):
        for line in block.splitlines():
            if line not in ran.stdout + ran.stderr:
                sys.exit(f"{PAGE}: '{line}' was not printed, but:\n{ran.stdout}{ran.stderr}")


def repeat(prefix, build, times):
    begun = time.monotonic()
    canary = [sys.executable, HERE / "canary.py", prefix / EXAMPLE / "laboratory.ringmap.toml"]
    for number in range(times):
        command = canary + ["ctest", "--test-dir", build, "-j8", "--output-on-failure"]
        ran = subprocess.run(command, env=environment(prefix), capture_output=True, text=True)
        if ran.returncode != 0:
            sys.exit(f"the tests of the example, time {number + 1} of {times}:\n{ran.stdout}{ran.stderr}")
    print(f"{times} times ctest -j8 in {time.monotonic() - begun:.1f} s")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("prefix", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--times", type=int, default=1)
    arguments = parser.parse_args()
    prefix, folder = arguments.prefix.resolve(), arguments.folder.resolve()
    folder.mkdir(parents=True)
    check_excerpts(prefix)
    run_page(prefix, folder)
    repeat(prefix, folder / "testing/build", arguments.times)


if __name__ == "__main__":
    main()

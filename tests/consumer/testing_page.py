#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tries docs/testing.md with the installed package, then repeats all tests of its example beside a canary.

    testing_page.py PREFIX FOLDER [--times N]
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
PAGES = HERE.parents[1] / "tests/docs/pages.py"
EXAMPLE = "share/rths/examples/testing"


def environment(prefix):
    (site,) = prefix.glob("lib/python3.*/site-packages")
    return {**os.environ, "PATH": f"{prefix}/bin:{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}",
            "PYTHONPATH": str(site), "PREFIX": str(prefix),
            "CMAKE_PREFIX_PATH": str(prefix), "CMAKE_GENERATOR": "Ninja", "PYTHONDONTWRITEBYTECODE": "1"}


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
    tried = subprocess.run([sys.executable, PAGES, prefix, "--prefix", prefix, "--folder", folder, "docs/testing.md"])
    if tried.returncode != 0:
        sys.exit(tried.returncode)
    repeat(prefix, folder / "page/testing/build", arguments.times)


if __name__ == "__main__":
    main()

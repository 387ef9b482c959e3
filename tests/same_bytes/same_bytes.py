#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares two builds: same input, same bytes.

    same_bytes.py OLD NEW [--set KEY=VALUE]… [--no-diagnosis] [--only PATTERN] [--cases FOLDER] [--out FOLDER]

OLD and NEW are `rths` commands, each with its share/ folder beside it. Both run every experiment of this tree's examples in
virtual time and diagnose every case below --cases, such as those that `rths bench diagnosis --out` has made. Equal must be: exit
status, standard output, standard error, the set of files, each recording outside /meta, and every other file byte by byte, but
for the time of the run, the seconds that it took and the version of the program. Exit status 1: something differs. Needs h5diff.
"""
import argparse
import concurrent.futures
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
LIMIT_S = 3000
VARYING = re.compile(rb'"(seconds|version|started|times_real_time|wall_time_s)": *("[^"]*"|[^,}\s]*)|^rths: step .*, \d+ s$\n?', re.M)


def experiments():
    """Experiment files that run on one host."""
    files = sorted(EXAMPLES.glob("*.toml")) + sorted(EXAMPLES.glob("*/*.toml")) + sorted(EXAMPLES.glob("*/*/*.toml"))
    for file in files:
        text = file.read_text()
        if re.search(r"^format = ", text, re.M) and re.search(r"^\[node\.", text, re.M) and not re.search(r"^\[host\.", text, re.M):
            yield file


def run(command, folder, arguments):
    """Runs in a folder of its own, whose name does not tell the build. @returns status, standard output and error"""
    folder.mkdir(parents=True)
    done = subprocess.run([command, *arguments], cwd=folder, capture_output=True, timeout=LIMIT_S, check=False,
                          stdin=subprocess.DEVNULL)
    return done.returncode, VARYING.sub(b"", done.stdout), VARYING.sub(b"", done.stderr)


def files_below(folder):
    return sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file() and file.name != "lock")


def differs(old, new):
    """How two files differ; empty if they are the same."""
    if old.suffix == ".h5":
        told = subprocess.run(["h5diff", "--exclude-path", "/meta", str(old), str(new)], capture_output=True, text=True, check=False)
        return "" if told.returncode == 0 else (told.stdout + told.stderr).strip()[:400]
    a, b = (VARYING.sub(b"", file.read_bytes()) for file in (old, new))
    if a == b:
        return ""
    at = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    return f"byte {at}: {a[max(0, at - 40):at + 40]!r} became {b[max(0, at - 40):at + 40]!r}"


def compared(name, arguments, options, work):
    """Differences of one run or diagnosis, a line each, and its exit status."""
    told = []
    for build in ("old", "new"):
        shutil.rmtree(work / build / name, ignore_errors=True)
        told.append(run(getattr(options, build), work / build / name, arguments))
    lines = [f"{what}: {a!r} became {b!r}" for what, a, b in zip(("exit status", "standard output", "standard error"), *told) if a != b]
    old, new = files_below(work / "old" / name), files_below(work / "new" / name)
    lines += [f"{file}: only in one" for file in sorted(set(old) ^ set(new))]
    for file in sorted(set(old) & set(new)):
        if told_of := differs(work / "old" / name / file, work / "new" / name / file):
            lines.append(f"{file}: {told_of}")
    if not lines and not options.out:
        for build in ("old", "new"):
            shutil.rmtree(work / build / name)
    return name, told[0][0], len(old), lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("old", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("new", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--set", action="append", default=[], help="changes every experiment")
    parser.add_argument("--no-diagnosis", action="store_true", help="of the examples; their recordings are the same")
    parser.add_argument("--only", default="*", help="names of experiments and cases")
    parser.add_argument("--cases", type=pathlib.Path, help="folder of cases")
    parser.add_argument("--out", type=pathlib.Path, help="keeps the results here")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    changes = ["--no-diagnosis"] * options.no_diagnosis + [word for change in options.set for word in ("--set", change)]
    plan = [(f"examples/{file.relative_to(EXAMPLES).with_suffix('')}",
             ["run", str(file), "--clock", "virtual", "--out", "out", *changes]) for file in experiments()]
    if options.cases:
        plan += [(f"cases/{case.name}", ["diagnose", str(case.resolve()), "--out", "out"])
                 for case in sorted(options.cases.iterdir()) if case.is_dir()]
    plan = [one for one in plan if fnmatch.fnmatch(one[0], options.only)]
    if not plan:
        sys.exit(f"{options.only}: names no experiment or case")
    different = 0
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        work = options.out or pathlib.Path(temporary)
        for name, status, count, lines in pool.map(lambda one: compared(*one, options, work), plan):
            different += bool(lines)
            print(f"{'DIFFERS' if lines else 'same':8} {name}  exit status {status}, {count} files", flush=True)
            for line in lines:
                print(f"         {line}", flush=True)
    print(f"{len(plan) - different} same, {different} different")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())

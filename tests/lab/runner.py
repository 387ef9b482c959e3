"""Runs tests of a build: small tests of a program together in one process, all others by ctest."""
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from collections import defaultdict
from dataclasses import dataclass, field

import results
from progress import say, watched

ALONE = "own_process"  # label of a small test that does not share its process


@dataclass
class Test:
    number: int  # of ctest
    name: str
    command: list
    labels: set = field(default_factory=set)
    environment: tuple = ()
    folder: str = None  # in which it runs
    has_more: bool = False  # fixtures, or a processor of its own

    @property
    def filter(self):
        """Its name in its program; empty if the program is not one of GoogleTest."""
        prefix = "--gtest_filter="
        named = [part[len(prefix):] for part in self.command[1:] if part.startswith(prefix)]
        return named[0] if len(named) == 1 and "*" not in named[0] and not named[0].startswith("-") else ""

    @property
    def is_small(self):
        """Runs well in one process with others of its program."""
        return bool(self.filter) and "unit" in self.labels and not self.labels & {ALONE, "long"} and not self.has_more


def tests_of(build, *arguments):
    """All tests of a build, as ctest has them."""
    listing = json.loads(subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1", *arguments],
                                        capture_output=True, text=True, check=True).stdout)
    found = []
    for number, entry in enumerate(listing["tests"], 1):
        values = {each["name"]: each["value"] for each in entry.get("properties", [])}
        has_more = bool(values.get("RUN_SERIAL") or values.get("FIXTURES_REQUIRED") or values.get("RESOURCE_LOCK"))
        found.append(Test(number, entry["name"], entry.get("command", []), set(values.get("LABELS", [])),
                          tuple(sorted(values.get("ENVIRONMENT", []))), values.get("WORKING_DIRECTORY"), has_more))
    return found


# --- small tests --------------------------------------------------------------------------------------

def batches_of(tests, most=60):
    """Small tests by program and environment, at most so many in a process, the largest batches first."""
    programs = defaultdict(list)
    for test in tests:
        if test.is_small:
            programs[test.command[0], test.environment].append(test)
    parts = []
    for batch in programs.values():
        count = -(-len(batch) // most)
        parts += [batch[start::count] for start in range(count)]
    return sorted((part for part in parts if len(part) > 1), key=len, reverse=True)


def run_batch(batch, folder, timeout=600):
    """Results of a program's tests in one process. Those that it did not reach have none."""
    flags, output = folder / f"{batch[0].number}.flags", folder / f"{batch[0].number}.xml"
    flags.write_text("--gtest_filter=" + ":".join(test.filter for test in batch) + "\n")
    environment = os.environ | dict(entry.split("=", 1) for entry in batch[0].environment)
    try:
        subprocess.run([batch[0].command[0], f"--gtest_flagfile={flags}", f"--gtest_output=xml:{output}"], env=environment, cwd=batch[0].folder,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        return []
    names = {test.filter: test.name for test in batch}
    found = [result for result in results.of_gtest(output) if result.name in names]
    for result in found:
        result.name = names[result.name]
    return found


def run_small(tests, jobs):
    """Results of all small tests. The others, and those without a result, are left to ctest."""
    batches = batches_of(tests)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return [result for found in pool.map(lambda batch: run_batch(batch, pathlib.Path(folder)), batches) for result in found]


# --- the others ---------------------------------------------------------------------------------------

def run_ctest(build, tests, label, jobs):
    """Results of these tests by ctest, with the fixtures that they need; None: ctest did not run."""
    build = pathlib.Path(build).resolve()
    output, log, numbers = build / "results.xml", build / "tests.log", build / "tests.numbers"
    output.unlink(missing_ok=True)
    numbers.write_text("0,0,0," + ",".join(str(test.number) for test in tests) + "\n")
    watched(label, ["ctest", "--test-dir", str(build), "-j", str(jobs), "--output-on-failure", "--no-tests=error",
                    "--output-junit", str(output), "-I", str(numbers)], log)
    if not output.is_file():
        say(f"{label} did not run")
        print(log.read_text(errors="replace"), file=sys.stderr)
        return None
    return results.of_ctest(output)


def in_groups(tests, jobs):
    """Tests that ctest runs together, and how many at once: one more than processors, because some wait for others. Those in
    real time wait more than they compute, but lose their ticks beside tests that compute."""
    in_real_time = [test for test in tests if "realtime" in test.labels]
    others = [test for test in tests if "realtime" not in test.labels]
    return [(group, count) for group, count in ((others, jobs + 1), (in_real_time, 2 * jobs)) if group]


def run(build, tests, label, jobs, is_long=False):
    """Results of all these tests, each once; None: ctest did not run. In long runs, each has its own process and deadline."""
    found = [] if is_long else run_small(tests, jobs)
    done = {result.name for result in found}
    for group, count in in_groups([test for test in tests if test.name not in done], jobs):
        rest = run_ctest(build, group, label, count)
        if rest is None:
            return None
        names = {test.name for test in group}
        found += [result for result in rest if result.name in names]
        reached = {result.name for result in rest}
        found += [results.Result(test.name, "failed", output="ctest did not run it") for test in group if test.name not in reached]
    return found

#!/usr/bin/env python3
"""`./lab test`, called by the script lab, which has installed the compiler and the libraries.

    main.py [--full | --sanitizers] [FOLDER…]

The last line on standard output is "N passed, N failed". Standard library only.
"""
import argparse
import os
import pathlib
import signal
import subprocess
import sys

import checks
import runner
from checks import TOP
from progress import say
from session import Session

TESTED = ["-DRTHS_TESTS=ON", "-DRTHS_PYTHON=ON"]
WITH_BENCHMARKS, WITHOUT_BENCHMARKS = "-DRTHS_BENCHMARKS=ON", "-DRTHS_BENCHMARKS=OFF"
ONLY_FULL = ["tests with the label long: models of protocols, more diagnoses, other versions of NumPy",
             "benchmarks and their tests, blind cases of the diagnosis, pip", "clang-tidy, headers and sources by themselves"]


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="./lab test", description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="also the long tests, benchmarks, clang-tidy and all sanitizers")
    parser.add_argument("--sanitizers", action="store_true", help="format, and the tests with clang and its sanitizers")
    parser.add_argument("folders", nargs="*", metavar="FOLDER", help="tests of these folders of tests/ alone")
    options = parser.parse_args(arguments)
    for folder in options.folders:
        if not (TOP / "tests" / folder).is_dir():
            there = " ".join(sorted(path.name for path in (TOP / "tests").iterdir() if path.is_dir()))
            parser.error(f"tests/{folder} is no folder; there are: {there}")
    return options


def packages(*groups):
    """Starts to install packages. An interrupted run must not leave an installation half done: it goes on to its end."""
    return subprocess.Popen([TOP / "lab", "packages", *groups], cwd=TOP,
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))


def use_opensees():
    """OpenSees scripts run with the Python installed by ./lab, unless RTHS_OPENSEES_PYTHON names another."""
    made = TOP / "build/opensees/bin/python"
    if made.exists():
        os.environ.setdefault("RTHS_OPENSEES_PYTHON", str(made))


# --- the release build --------------------------------------------------------------------------------

def parts_of(tests, is_full):
    """Name and tests of each suite. With --full, an interrupted run resumes with the part that has not passed."""
    tests = [test for test in tests if "fixture" not in test.labels]
    if not is_full:
        return [("tests of 'release'", [test for test in tests if "long" not in test.labels])]
    parts = {}
    for test in tests:
        kind = next((kind for kind in ("unit", "physics", "system") if kind in test.labels), "real time")
        parts.setdefault(kind, []).append(test)
    return [(f"tests of 'release', {kind}", parts[kind]) for kind in parts]


def test_release(session, is_full, waiting):
    benchmarks = WITH_BENCHMARKS if is_full else WITHOUT_BENCHMARKS
    is_built = session.stage("release builds", lambda: checks.build("release", "all", *TESTED, benchmarks), is_recalled=False)
    if waiting.wait() != 0:
        session.fail("packages for the tests")
    use_opensees()
    if not is_built:
        return
    for name, tests in parts_of(runner.tests_of(checks.RELEASE), is_full):
        session.suite(checks.RELEASE, tests, name)
    session.stage("the installed package serves a consumer", lambda: checks.serves_a_consumer(20 if is_full else 1))
    session.stage("the installed libraries serve vendor-API programs", checks.serves_vendor_clients)


def test_more(session):
    """Only with --full."""
    session.stage("pip installs the Python package", checks.installs_by_pip)
    if "RTHS_OPENSEES_PYTHON" in os.environ:
        session.stage("the diagnosis finds concealed effects", checks.finds_concealed_effects)
    else:
        session.fail("the diagnosis finds concealed effects: blind cases need NumPy and OpenSees")
    # Afterwards, because it links the command again.
    session.stage("the benchmarks run", checks.benchmarks_build_and_run)


# --- sanitizers ---------------------------------------------------------------------------------------

def sanitized_targets(preset, options, folders):
    """What a sanitizer builds: all, or the tests of these folders of tests/."""
    if not folders:
        return ["rths_tested"]
    if not checks.quietly("cmake", "--preset", preset, *options):
        say("configuring failed")
        sys.exit(2)
    lines = [line.split() for line in (TOP / "build" / preset / "tests.txt").read_text().splitlines()]
    return [target for folder, target in lines if folder in folders]


def test_sanitizers(session, is_full, folders=()):
    os.environ.pop("RTHS_LONG", None)  # more repetitions of the same code would take hours
    session.stage("sources are formatted", checks.is_formatted)
    options = ["-DRTHS_TESTS=ON", WITH_BENCHMARKS if is_full else WITHOUT_BENCHMARKS]
    for preset, name in (("asan", "address and undefined-behaviour sanitizers"), ("tsan", "thread sanitizer")):
        folder = TOP / "build" / preset
        targets = sanitized_targets(preset, options, folders)
        if targets and session.stage(f"clang builds, with {name}", lambda: checks.build(preset, *targets, *options), is_recalled=False):
            tests = [test for test in runner.tests_of(folder) if not test.labels & {"realtime", "fixture", *([] if is_full else ["long"])}]
            tests = tests_of_targets(tests, targets) if folders else tests
            session.suite(folder, tests, f"tests of '{preset}'")
            left_out = (folder / "not_run.txt").read_text().splitlines()
            session.skipped.append(f"tests of '{preset}': {len(left_out)} targets, for the reasons in {folder.relative_to(TOP)}/not_run.txt")
    if is_full:
        session.stage("public headers stand alone", lambda: checks.build("asan", "all_verify_interface_header_sets"))
        session.stage("sources stand alone", checks.sources_stand_alone)
        session.stage("sources are tidy", checks.is_tidy)


# --- folders ------------------------------------------------------------------------------------------

def targets_of(folders):
    """Targets with tests in these folders of tests/, from the list that CMake writes."""
    listing = checks.RELEASE / "tests.txt"
    needs_benchmarks = "benchmarks" in folders
    if listing.exists() and not needs_benchmarks:
        is_configured = checks.quietly("ninja", "-C", checks.RELEASE, "build.ninja")
    else:
        is_configured = checks.quietly("cmake", "--preset", "release", *TESTED, WITH_BENCHMARKS if needs_benchmarks else WITHOUT_BENCHMARKS)
    if not is_configured:
        say("configuring failed")
        sys.exit(2)
    lines = [line.split() for line in listing.read_text().splitlines()]
    return [target for folder, target in lines if folder in folders]


def tests_of_targets(tests, targets):
    """The tests of these targets: those of its program, or of the suite that the target names."""
    programs = set(targets)
    suites = {target.removeprefix("rths_").removesuffix("_test") for target in targets}
    return [test for test in tests if "long" not in test.labels and "fixture" not in test.labels
            and (pathlib.Path((test.command or [""])[0]).name in programs or test.name.split(".")[0] in suites)]


def test_folders(session, folders):
    targets = targets_of(folders)
    if not targets:
        say(f"no tests in: {' '.join(folders)}")
        sys.exit(2)
    if session.stage("release builds", lambda: checks.build("release", *targets), is_recalled=False):
        use_opensees()
        session.suite(checks.RELEASE, tests_of_targets(runner.tests_of(checks.RELEASE), targets), "tests of 'release'")
        session.repeat_alone()
        say("slowest tests:")
        session.print_slowest(3)
    return session.end()


# --- all ----------------------------------------------------------------------------------------------

def print_times(session, reference):
    say(f"a reference source compiles in {reference:.1f} s here")
    for line in session.times:
        say(line)
    say("slowest tests:")
    session.print_slowest(10)
    for line in session.skipped:
        say(f"SKIPPED in {line}")


def resumed_folder():
    folder = TOP / "build/full" / checks.tree_hash()
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def main():
    # Started in the background, all tests would ignore these.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for each in (signal.SIGHUP, signal.SIGQUIT):
        signal.signal(each, signal.SIG_DFL)
    options = options_of(sys.argv[1:])
    session = Session(jobs=os.cpu_count() or 2)
    if options.folders and not options.sanitizers:
        return test_folders(session, options.folders)
    if options.full:
        os.environ["RTHS_LONG"] = "1"
        session.resumed = resumed_folder()
    reference = checks.reference_seconds()
    is_release = options.full or not options.sanitizers
    waiting = packages(*(["tests", "opensees"] if is_release else []), *(["numpys", "full"] if options.full else []),
                       *(["sanitizers"] if options.full or options.sanitizers else []))
    try:
        if is_release:
            test_release(session, options.full, waiting)
        if options.full:
            test_more(session)
        if options.full or options.sanitizers:
            if waiting.wait() != 0:
                session.fail("packages for the tests")
            test_sanitizers(session, options.full, options.folders)
        session.repeat_alone()
    finally:
        waiting.wait()
    print_times(session, reference)
    if not options.full:
        say(f"only with --full: {'; '.join(ONLY_FULL)}")
    if is_release and not options.full:
        say("only with --sanitizers: format, clang, and its address, undefined-behaviour and thread sanitizers")
    if session.failed == 0 and session.resumed is not None:
        for file in session.resumed.iterdir():
            file.unlink()
    return session.end()


if __name__ == "__main__":
    sys.exit(main())

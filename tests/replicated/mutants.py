#!/usr/bin/env python3
"""Changes operators and constants of the cards' code one at a time and counts how many changes the tests detect.

    tests/replicated/mutants.py [--sample N] [--seed S] [--jobs J] [--build FOLDER] [--list]

Needs a build of rths_replicated_test in FOLDER (build/release). Compiles only the changed source and links it to the built
tests. Prints a line per survivor and at the end "killed/total". Exits with 1 if less than 95 % were killed. Long: about two
seconds of computing time per change. Standard library only.
"""
import argparse
import concurrent.futures
import pathlib
import random
import re
import shlex
import subprocess
import sys
import tempfile

TREE = pathlib.Path(__file__).resolve().parents[2]
ENGINE = TREE / "broker/replicated/src"
CARD = TREE / "broker/scramnet/src"
SOURCES = [ENGINE / name for name in ("engine.cpp", "transmitter.cpp", "receiver.cpp", "plus_host.cpp", "gt_host.cpp", "cards.cpp")] + \
          [CARD / name for name in ("registers.cpp", "fifo.cpp", "gt_registers.cpp")]
LEAST_KILLED = 0.95
TIME_LIMIT_S = 60  # a change may make a test endless
SKIPPED = "-*On256Nodes*"  # long
# Constants of the random numbers and of the log's hash, of which others do as well; assertions, which are off;
# and a function of the cards in shared memory only.
EQUIVALENT = re.compile(r"\bz = |\bz \^|log_hash|0x9E37|0x1p-53|RTHS_ASSERT|bytes_of_size_code")

COMMENT_OR_TEXT = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|#[^\n]*|\btemplate <[^\n]*')
OPERATORS = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == ", " && ": " || ",
             " || ": " && ", " + ": " - ", " - ": " + ", " * ": " + ", " | ": " & ", " & ": " | ", " % ": " / ",
             " << ": " >> ", " >> ": " << ", "++": "--", " += ": " -= ", "!=": "==", "true": "false", "false": "true"}
OPERATOR = re.compile(r" (?:<=|>=|==|!=|&&|\|\||<<|>>|\+=|[<>+*|&%-]) |\+\+|\btrue\b|\bfalse\b")
NEGATION = re.compile(r"(?<=[( ])!(?=[a-z])")
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9A-F']+|\d[\d']*)(U?)(?![\w.'])")


def changes_of(source):
    """(begin, end, replacement) of every change of a source."""
    text = source.read_text()
    code = COMMENT_OR_TEXT.sub(lambda match: " " * len(match[0]), text)
    found = [(m.start(), m.end(), OPERATORS[m[0]]) for m in OPERATOR.finditer(code)]
    found += [(m.start(), m.end(), "") for m in NEGATION.finditer(code)]
    for m in NUMBER.finditer(code):
        found.append((m.start(), m.end(), f"{int(m[1].replace(chr(39), ''), 0) + 1}{m[2]}"))
    def line_of(begin):
        return text[text.rfind("\n", 0, begin) + 1:text.find("\n", begin)]
    return sorted(change for change in found if not EQUIVALENT.search(line_of(change[0])))


class Build:
    """Compiles and links as the build does."""

    def __init__(self, folder):
        self.folder = folder
        def commands(target):
            listing = subprocess.run(["ninja", "-C", folder, "-t", "commands", target], capture_output=True, text=True, check=True)
            return [line for line in listing.stdout.splitlines() if " -c " in line or " -o " in line]
        lines = commands("rths_replicated_test")
        line = next(line for line in lines if " -o bin/rths_replicated_test" in line)
        self.link = shlex.split(line.removeprefix(": && ").split(" && ")[0])
        compile_line = next(line for line in lines if "rths_replicated.dir" in line and " -c " in line)
        words = shlex.split(compile_line)
        skipped = {"-MD"}
        self.compile, take_next = [], False
        for word in words:
            if take_next or word in ("-MT", "-MF", "-o", "-c"):
                take_next = not take_next
                continue
            if word not in skipped:
                self.compile.append(word)
        self.compile += ["-O1", "-w", f"-I{ENGINE}", f"-I{CARD}", f"-I{TREE / 'broker/replicated/include'}"]

    def object_of(self, source, into):
        done = subprocess.run([*self.compile, "-c", str(source), "-o", str(into)], cwd=self.folder, capture_output=True, text=True)
        return done.returncode == 0

    def program(self, objects, into):
        words = []
        for word in self.link:
            words += [str(one) for one in objects] if word.endswith("librths_replicated.a") else [word]
        words[words.index("bin/rths_replicated_test")] = str(into)
        return subprocess.run(words, cwd=self.folder, capture_output=True, text=True)


def is_killed(program):
    try:
        return subprocess.run([program, f"--gtest_filter={SKIPPED}", "--gtest_fail_fast", "--gtest_brief=1"],
                              capture_output=True, timeout=TIME_LIMIT_S).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def place(source, begin):
    text = source.read_text()
    line = text.count("\n", 0, begin) + 1
    return f"{source.relative_to(TREE)}:{line}: {text.splitlines()[line - 1].strip()}"


def judge(build, base, source, change, folder):
    """killed, survived, or refused by the compiler."""
    begin, end, replacement = change
    text = source.read_text()
    with tempfile.TemporaryDirectory(dir=folder) as work:
        changed = pathlib.Path(work) / source.name
        changed.write_text(text[:begin] + replacement + text[end:])
        own = pathlib.Path(work) / "changed.o"
        if not build.object_of(changed, own):
            return "refused"
        program = pathlib.Path(work) / "test"
        linked = build.program([own] + [one for name, one in base.items() if name != source.name], program)
        if linked.returncode != 0:
            return "refused"
        return "killed" if is_killed(program) else "survived"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--sample", type=int, help="number of changes, drawn at random [all]")
    arguments.add_argument("--seed", type=int, default=1, help="of the draw")
    arguments.add_argument("--jobs", type=int, default=1)
    arguments.add_argument("--build", type=pathlib.Path, default=TREE / "build/release")
    arguments.add_argument("--list", action="store_true", help="print the number of changes per source")
    options = arguments.parse_args()
    changes = [(source, change) for source in SOURCES for change in changes_of(source)]
    if options.list:
        for source in SOURCES:
            print(f"{len(changes_of(source)):5} {source.relative_to(TREE)}")
        print(f"{len(changes):5}")
        return 0
    drawn = changes if options.sample is None else random.Random(options.seed).sample(changes, options.sample)
    build = Build(options.build)
    results = {"killed": 0, "survived": 0, "refused": 0}
    with tempfile.TemporaryDirectory() as folder:
        base = {}
        for source in sorted({*SOURCES, *ENGINE.glob("*.cpp")}):
            base[source.name] = pathlib.Path(folder) / f"{source.stem}.o"
            if not build.object_of(source, base[source.name]):
                sys.exit(f"{source} does not compile")
        program = pathlib.Path(folder) / "unchanged"
        linked = build.program(base.values(), program)
        if linked.returncode != 0:
            sys.exit(linked.stderr)
        if is_killed(program):
            sys.exit("the unchanged code fails its tests")
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            futures = {pool.submit(judge, build, base, source, change, folder): (source, change) for source, change in drawn}
            for future in concurrent.futures.as_completed(futures):
                source, (begin, end, replacement) = futures[future]
                results[future.result()] += 1
                if future.result() == "survived":
                    print(f"survived: {place(source, begin)}   [{source.read_text()[begin:end]!r} -> {replacement!r}]", flush=True)
    judged = results["killed"] + results["survived"]
    print(f"seed {options.seed}: {results['killed']}/{judged} killed of {len(changes)} possible changes, "
          f"{results['refused']} do not compile")
    return 0 if judged and results["killed"] >= LEAST_KILLED * judged else 1


if __name__ == "__main__":
    sys.exit(main())

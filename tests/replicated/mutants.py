#!/usr/bin/env python3
"""Changes the code of the cards in one place at a time and counts how many changes the tests detect.

    tests/replicated/mutants.py [--sample N] [--seed S] [--minutes M] [--jobs J] [--build FOLDER] [--only NAME] [--json FILE]
                                [--list]

A change swaps an operator, adds 1 to a number, drops a negation or a statement of one line, or turns a condition around. Needs
a build of rths_replicated_test in FOLDER (build/release). Compiles the changed file alone, against a precompiled header, and
links it to objects and tests that exist; a changed header is compiled with all sources in one unit. Prints a line per survivor
and at the end "killed/total". Exits with 1 if less than 95 % were killed. Half a second of computing time per change, four
for a change of a header. Standard library only.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import functools
import json
import pathlib
import random
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

TREE = pathlib.Path(__file__).resolve().parents[2]
ENGINE = TREE / "broker/replicated/src"
CARD = TREE / "broker/card/src"
CARD_HEADERS = TREE / "broker/card/include/rths/card"
SOURCES = [ENGINE / name for name in ("engine.cpp", "transmitter.cpp", "receiver.cpp", "plus_host.cpp", "gt_host.cpp", "cards.cpp")] + \
          [CARD / name for name in ("registers.cpp", "fifo.cpp", "gt_registers.cpp", "store_effect.cpp", "store_instruction.cpp")]
HEADERS = [ENGINE / name for name in ("events.hpp", "node.hpp")] + \
          [CARD_HEADERS / name for name in ("bits.hpp", "gt_registers.hpp")]
PRECOMPILED = ("cmath", "ctime", "array", "algorithm", "fmt/format.h", "rths/core/error.hpp", "engine.hpp", "rths/card/fifo.hpp", "rths/card/bits.hpp")
LEAST_KILLED = 0.95
LIMIT_S, LIMIT_BYTES = 6, 4 << 30  # computing time, ten times that of all tests, and memory: a change may make a test endless
SKIPPED = "-*On256Nodes*"  # long

# Changes that no test can detect: a part of the line, a part of the change (before -> after), and the reason.
EQUIVALENT = [
    (r"\bz = |\bz \^|0x9E37|0x1p-53", "", "constants of the random numbers, of which others do as well"),
    (r"log_hash|message\.number << 20U", "", "constants of the hash, of which others do as well"),
    (r"RTHS_ASSERT", "", "assertions are off in this build"),
    (r"^(Time time\{0\}|std::uint64_t sequence|std::uint32_t subject|std::uint16_t node = 0|bool own = false, damaged|"
     r"std::uint8_t hipro_bytes = 0|Time start\{0\}|Time transmit_at\{0\}|Time transit_since\{0\}|std::uint32_t (address|value) = 0;|"
     r"std::uint32_t (nodes = 1|upstream = 0);|bool closed = true;)", "", "initial values that are replaced before their first use"),
    (r"next_ = 0|std::uint32_t attempt = 0", "", "the number of the first event or attempt, which may be any"),
    (r"value_or\(0\) & 0xFFFC", "^0 -> 1", "a bit that the mask takes away"),
    (r"pages_\(\(bytes \+ kPage - 1\)", "- -> \\+", "one more page, which is never used"),
    (r"^kAllReceiveInterrupts = 0x40, kErrorInterrupts = ", "0x80 -> ", "demands bit 0 of CSR0, without which no host is interrupted"),
    (r"kHostInterrupts = ", "0x8 -> ", "demands bit 0 of CSR0, without which no host is interrupted"),
    (r"kMemoryInterrupts = ", "0x20 -> ", "demands bit 0 of CSR0, without which nothing is received"),
    (r"std::tie\(a.time, a.node, a.sequence\) > ", "> -> >=", "no two events have one number"),
    (r"byte << [123] & 8", "8 -> 9", "a bit that the shift has cleared"),
    (r"bytes_\[at_\] : 0; }", "0 -> 1", "behind the end: no prefix either"),
    (r"bit_error_rate_ == 0\) return", "if .* -> ;", "saves time only: no bit is damaged at a rate of 0"),
]

COMMENT_OR_TEXT = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|#[^\n]*|\btemplate <[^\n]*|\bstatic_assert\([^\n]*')
OPERATORS = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == ", " && ": " || ",
             " || ": " && ", " + ": " - ", " - ": " + ", " * ": " + ", " | ": " & ", " & ": " | ", " % ": " / ",
             " << ": " >> ", " >> ": " << ", "++": "--", " += ": " -= ", "!=": "==", "true": "false", "false": "true"}
OPERATOR = re.compile(r" (?:<=|>=|==|!=|&&|\|\||<<|>>|\+=|[<>+*|&%-]) |\+\+|\btrue\b|\bfalse\b")
NEGATION = re.compile(r"(?<=[( ])!(?=[a-z])")
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9A-F']+|\d[\d']*)(U?)(?![\w.'])")
CONDITION = re.compile(r"\bif \((?!const )(?=[^\n]*\) )")
STATEMENT = re.compile(r"(?<=[;{}):]\n)( +)(?! |return [^;]|case |const |auto |using |static |constexpr |struct |std::\w+ \w+|\}|\[\[)([^\n{};]+;)(?=\n)")


@functools.cache
def text_of(file):
    return file.read_text()


@dataclasses.dataclass(frozen=True)
class Change:
    file: pathlib.Path
    begin: int
    end: int
    after: str

    def applied(self):
        text = text_of(self.file)
        return text[:self.begin] + self.after + text[self.end:]

    def line(self):
        """Number and text of the line."""
        text = text_of(self.file)
        number = text.count("\n", 0, self.begin) + 1
        return number, text.splitlines()[number - 1].strip()

    def __str__(self):
        number, line = self.line()
        before = text_of(self.file)[self.begin:self.end].strip()
        return f"{self.file.relative_to(TREE)}:{number}: {line}   [{before!r} -> {self.after.strip()!r}]"

    def reason(self):
        """Why no test can detect this change; None if one can."""
        what = f"{text_of(self.file)[self.begin:self.end].strip()} -> {self.after.strip()}"
        for line, change, reason in EQUIVALENT:
            if re.search(line, self.line()[1]) and re.search(change, what):
                return reason
        return None


def changes_of(file):
    text = text_of(file)
    code = COMMENT_OR_TEXT.sub(lambda match: " " * len(match[0]), text)
    found = {(m.start(), m.end(), OPERATORS[m[0]]) for m in OPERATOR.finditer(code)}
    found |= {(m.start(), m.end(), "") for m in NEGATION.finditer(code)}
    found |= {(m.start(), m.end(), f"{int(m[1].replace(chr(39), ''), 0) + 1}{m[2]}") for m in NUMBER.finditer(code)}
    found |= {(m.start(2), m.end(2), ";") for m in STATEMENT.finditer(re.sub(r" +(?=\n)", lambda s: " " * len(s[0]), code))}
    for m in CONDITION.finditer(code):
        depth, end = 1, m.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(code[end], 0)
            end += 1
        condition = code[m.end():end - 1]
        if not OPERATOR.search(condition) and not condition.startswith("!"):
            found.add((m.end(), end - 1, f"!({condition})"))
    return [Change(file, *change) for change in sorted(found)]


@functools.cache
def included(file):
    """Names of the headers of the cards that a file includes, also through others."""
    names = set()
    for name in re.findall(r'#include ["<](?:rths/card/)?(\w+\.hpp)[">]', text_of(file)):
        for folder in (ENGINE, CARD_HEADERS):
            if (folder / name).exists():
                names |= {name} | included(folder / name)
    return names


class Build:
    """Compiles and links as the build does."""

    def __init__(self, folder, work, jobs):
        self.folder, self.work = folder, work
        for part in ("broker", "core", "memmap"):  # the tree may change meanwhile
            shutil.copytree(TREE / part, work / part)
        listing = subprocess.run(["ninja", "-C", folder, "-t", "commands", "rths_replicated_test"],
                                 capture_output=True, text=True, check=True).stdout.splitlines()
        link = next(line for line in listing if " -o bin/rths_replicated_test" in line)
        self.link = shlex.split(link.removeprefix(": && ").split(" && ")[0])
        if shutil.which("ld.gold"):
            self.link.append("-fuse-ld=gold")  # faster
        words = shlex.split(next(line for line in listing if "rths_replicated.dir" in line and " -c " in line))
        words = [word for i, word in enumerate(words)
                 if word not in ("-MD", "-MT", "-MF", "-o", "-c") and words[i - 1] not in ("-MT", "-MF", "-o", "-c")]
        words += ["-w", f"-I{ENGINE}"]
        self.compiler = [word.replace(f"-I{TREE}", f"-I{work}") for word in words]
        self.sources = sorted({*ENGINE.glob("*.cpp"), *CARD.glob("*.cpp")})
        header = work / "precompiled.hpp"
        header.write_text("".join(f"#include <{name}>\n" for name in PRECOMPILED))
        self.header = header
        self.objects = {source: work / f"{source.stem}.o" for source in self.sources}
        commands = [["-O0", "-x", "c++-header", str(header), "-o", f"{header}.gch"]]
        commands += [["-O1", "-c", str(work / source.relative_to(TREE)), "-o", str(one)] for source, one in self.objects.items()]
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            if not all(pool.map(lambda command: self.run([*self.compiler, *command]), commands)):
                sys.exit("the unchanged code does not compile")

    def run(self, command):
        return subprocess.run(command, cwd=self.folder, capture_output=True, text=True).returncode == 0

    def compiled(self, change, folder):
        """Objects of the tree with this change; None if it does not compile."""
        own = folder / "changed.o"
        if change.file in self.objects:
            changed = folder / change.file.name
            changed.write_text(change.applied())
            done = self.run([*self.compiler, "-O0", "-include", str(self.header), "-c", str(changed), "-o", str(own)])
            return [own] + [one for source, one in self.objects.items() if source != change.file] if done else None
        card = folder / "rths/card"
        card.mkdir(parents=True)
        for one in {*ENGINE.glob("*.hpp"), *CARD_HEADERS.glob("*.hpp"), *self.sources}:
            shutil.copy(self.work / one.relative_to(TREE), card if one.parent == CARD_HEADERS else folder)
        ((card if change.file.parent == CARD_HEADERS else folder) / change.file.name).write_text(change.applied())
        users = [source for source in self.sources if change.file.name in included(source)]
        unit = folder / "all.cpp"
        unit.write_text("".join(f'#include "{source.name}"\n' for source in users))
        words = [word for word in self.compiler if not word.endswith(("replicated/src", "card/include"))]
        done = self.run([*words, "-O0", f"-I{folder}", "-c", str(unit), "-o", str(own)])
        return [own] + [one for source, one in self.objects.items() if source not in users] if done else None

    def program(self, objects, into):
        words = []
        for word in self.link:
            if not word.endswith("librths_card.a"):
                words += [str(one) for one in objects] if word.endswith("librths_replicated.a") else [word]
        words[words.index("bin/rths_replicated_test")] = str(into)
        return self.run(words)


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT_S, LIMIT_S))
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def is_killed(program):
    try:
        return subprocess.run([program, f"--gtest_filter={SKIPPED}", "--gtest_fail_fast", "--gtest_brief=1"],
                              capture_output=True, timeout=20 * LIMIT_S, preexec_fn=limits).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def judge(build, change, deadline):
    """killed, survived, refused by the compiler, or late."""
    if time.monotonic() > deadline:
        return "late"
    with tempfile.TemporaryDirectory(dir=build.work) as folder:
        objects = build.compiled(change, pathlib.Path(folder))
        program = pathlib.Path(folder) / "test"
        if objects is None or not build.program(objects, program):
            return "refused"
        return "killed" if is_killed(program) else "survived"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--sample", type=int, help="number of changes, drawn at random [all]")
    arguments.add_argument("--seed", type=int, default=1, help="of the draw")
    arguments.add_argument("--jobs", type=int, default=1)
    arguments.add_argument("--build", type=pathlib.Path, default=TREE / "build/release")
    arguments.add_argument("--minutes", type=float, default=1e9, help="begins no change later [no limit]")
    arguments.add_argument("--only", help="a file's name")
    arguments.add_argument("--json", type=pathlib.Path, help="file for the result")
    arguments.add_argument("--list", action="store_true", help="print the number of changes per file")
    options = arguments.parse_args()
    files = [file for file in SOURCES + HEADERS if options.only in (None, file.name)]
    possible = [change for file in files for change in changes_of(file)]
    equivalent = collections.Counter(change.reason() for change in possible)
    changes = [change for change in possible if change.reason() is None]
    if options.list:
        for file in files:
            print(f"{sum(change.file == file for change in changes):5} {file.relative_to(TREE)}")
    for reason, number in equivalent.items():
        if reason is not None:
            print(f"{number:5} not judged: {reason}")
    if options.list:
        return 0
    deadline = time.monotonic() + 60 * options.minutes
    drawn = changes if options.sample is None else random.Random(options.seed).sample(changes, min(options.sample, len(changes)))
    counts = {file: collections.Counter() for file in files}
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        build = Build(options.build, pathlib.Path(folder), options.jobs)
        program = pathlib.Path(folder) / "unchanged"
        if not build.program(build.objects.values(), program):
            sys.exit("the unchanged code does not link")
        if is_killed(program):
            sys.exit("the unchanged code fails its tests")
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            futures = {pool.submit(judge, build, change, deadline): change for change in drawn}
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                change = futures[future]
                counts[change.file][future.result()] += 1
                if future.result() == "survived":
                    survivors.append(str(change))
                    print(f"survived: {change}", flush=True)
                if done % 50 == 0:
                    print(f"{done} of {len(drawn)}", file=sys.stderr, flush=True)
    total = sum(counts.values(), collections.Counter())
    judged = total["killed"] + total["survived"]
    print(f"seed {options.seed}: {total['killed']}/{judged} killed of {len(changes)} possible changes, "
          f"{total['refused']} do not compile")
    if options.json:
        result = {"possible": len(changes), "drawn": len(drawn) - total["late"], "seed": options.seed, "killed": total["killed"], "judged": judged,
                  "killed_percent": 100 * total["killed"] / judged, "do_not_compile": total["refused"],
                  "not_judged": {reason: number for reason, number in equivalent.items() if reason is not None},
                  "survivors": sorted(survivors),
                  "files": [{"name": str(file.relative_to(TREE)), **{key: counts[file][key] for key in ("killed", "survived", "refused")}}
                            for file in files]}
        options.json.write_text(json.dumps(result, indent=2) + "\n")
    return 0 if judged and total["killed"] >= LEAST_KILLED * judged else 1


if __name__ == "__main__":
    sys.exit(main())

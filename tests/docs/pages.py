#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs, compiles or checks every block of code on every page, from the text of the page.

    tests/docs/pages.py BUILD [--long] [--prefix PREFIX] [--folder FOLDER] [PAGE…]

tests/docs/README.md has the rules. Prints one line per failed and per excused block, and the counts. Exits with 1 if a block
failed. --long runs the pages that have long blocks, with these blocks; without it they are excused. Standard library only.
"""
import argparse
import collections
import dataclasses
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import toml_parts

TREE = pathlib.Path(__file__).resolve().parents[2]
PIECES = re.compile(r"(?:^<!-- [^\n]* -->\n+)*^```(?P<language>\S*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
MARK = re.compile(r"^<!-- (?P<key>[a-z ]+?)(?:: (?P<value>[^\n]*?))? -->$", re.MULTILINE)
MARKS = {"not run", "needs", "long", "before", "exit", "file", "into", "part of", "with", "within", "picture", "fresh"}
UNFENCED = re.compile(r"^\n {4}(?:rths |\./lab|build/|sudo |cmake |pip |#include|\[\w|import )[^\n]*", re.MULTILINE)
IN_REAL_TIME = re.compile(r"rths run (?!.*--clock virtual)")
DEADLINE_S = 600


class Failed(Exception):
    """A block does not do what its page says."""


class Excused(Exception):
    """A block cannot be tried here."""


def shown(page):
    return os.path.relpath(page, TREE)


@dataclasses.dataclass
class Block:
    """A fenced block of a page, with the marks in front of it."""
    page: pathlib.Path
    line: int
    language: str
    text: str
    marks: dict

    @property
    def place(self):
        return f"{shown(self.page)}:{self.line}"


def blocks_of(page):
    text = page.read_text(encoding="utf-8")
    for piece in PIECES.finditer(text):
        marks = {mark["key"]: mark["value"] or "" for mark in MARK.finditer(piece[0][:piece.start("language") - piece.start()])}
        yield Block(page, text[:piece.start("text")].count("\n"), piece["language"], piece["text"], marks)


def pages(names):
    """The named pages, or all of the project."""
    listing = subprocess.run(["git", "-c", f"safe.directory={TREE}", "ls-files", "-co", "--exclude-standard", "*.md"],
                             cwd=TREE, capture_output=True, text=True, check=True).stdout.split()
    return [TREE / name for name in names or listing if (TREE / name).is_file()]


def needs(build, prefix):
    """The needs that a block may state, and whether each is met."""
    def modules(*names):
        return all(importlib.util.find_spec(name) is not None for name in names)

    return {"the Python package": modules("numpy") and any((build / "python").glob("rths/_*.so")),
            "NumPy": modules("numpy"), "pandas": modules("pandas"), "Matplotlib": modules("matplotlib"), "pytest": modules("pytest"),
            "OpenSees": bool(os.environ.get("RTHS_OPENSEES_PYTHON")), "an installed package": prefix is not None}


class Shell:
    """A shell that keeps its folder and its variables from block to block."""

    def __init__(self, folder, environment):
        self.environment, self.state = environment, folder.parent / "state"
        self.state.write_text(f"cd '{folder}'\n")

    def run(self, text):
        script = f"source {self.state}\nset -eo pipefail\n{text}\n{{ export -p; echo \"cd '$PWD'\"; }} >{self.state}\n"
        return subprocess.run(["bash", "-c", script], env=self.environment, text=True, timeout=DEADLINE_S,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    @property
    def folder(self):
        return pathlib.Path(re.findall(r"^cd '(.*)'$", self.state.read_text(), re.MULTILINE)[-1])


class Interpreter:
    """A Python that keeps its names from block to block."""
    LOOP = """
import json, os, sys, traceback
names = {"__name__": "page"}
answers = os.fdopen(os.dup(1), "w")
for request in sys.stdin:
    request = json.loads(request)
    os.chdir(request["folder"])
    trouble = ""
    try:
        exec(compile("\\n" * request["line"] + request["text"], request["page"], "exec"), names)
    except BaseException:
        trouble = traceback.format_exc()
    sys.stdout.flush()
    print("\\0" + json.dumps(trouble), file=answers, flush=True)
"""

    def __init__(self, environment):
        self.process = subprocess.Popen([sys.executable, "-c", self.LOOP], env=environment, text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, block, folder):
        request = {"folder": str(folder), "line": block.line, "text": block.text, "page": str(block.page)}
        print(json.dumps(request), file=self.process.stdin, flush=True)
        output = ""
        for line in self.process.stdout:
            output, ended, trouble = (output + line).partition("\0")
            if ended:
                if json.loads(trouble):
                    raise Failed(json.loads(trouble))
                return output
        raise Failed(f"Python ended:\n{output}")

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Page:
    """Tries the blocks of one page in their order, in a folder of its own."""

    def __init__(self, options, here, folder):
        self.options, self.here, self.printed = options, here, ""
        build, prefix = options.build, options.prefix or options.build
        (folder / "page").mkdir(parents=True)
        (folder / "page/examples").symlink_to(TREE / "examples")
        lab = folder / "page/lab"
        lab.write_text('#!/bin/sh\ntest "$1" = rths && shift && exec rths "$@"\n')
        lab.chmod(0o755)
        (folder / "bin").mkdir()
        (folder / "bin/table").symlink_to(TREE / "tests/docs/table.py")
        paths = [str(folder / "bin"), str(prefix / "bin"), str(pathlib.Path(sys.executable).parent), os.environ["PATH"]]
        sites = [str(site) for site in prefix.glob("lib/python3.*/site-packages")] or [str(build / "python")]
        self.environment = {**os.environ, "PATH": ":".join(paths), "PYTHONPATH": ":".join(sites), "PREFIX": str(prefix),
                            "EXAMPLES": str(TREE / "examples"), "CMAKE_GENERATOR": "Ninja", "PYTHONDONTWRITEBYTECODE": "1",
                            "CMAKE_PREFIX_PATH": str(prefix), "MPLBACKEND": "agg"}
        self.shell = Shell(folder / "page", self.environment)
        self.interpreter = None

    def close(self):
        if self.interpreter:
            self.interpreter.close()

    def attempt(self, block):
        """Returns "run" or "checked"."""
        if unknown := set(block.marks) - MARKS:
            raise Failed(f"unknown mark {unknown}, expected one of {sorted(MARKS)}")
        if "not run" in block.marks:
            raise Excused(block.marks["not run"])
        imports = ["the Python package"] if block.language == "python" and "import rths\n" in block.page.read_text() else []
        for need in imports + [need for need in block.marks.get("needs", "").split(", ") if need]:
            if need not in self.here:
                raise Failed(f"unknown need '{need}', expected one of {sorted(self.here)}")
            if not self.here[need]:
                raise Excused(f"needs {need}")
        if "long" in block.marks and not self.options.long:
            raise Excused("long")
        if "before" in block.marks:
            self.command(block.marks["before"])
        if "part of" in block.marks:
            return self.excerpt(block)
        if "file" in block.marks:
            (self.shell.folder / block.marks["file"]).write_text(block.text)
        attempt = {"sh": self.sh, "text": self.output, "toml": self.toml, "python": self.python, "c": self.compiled,
                   "cpp": self.compiled}.get(block.language)
        if attempt is None:
            raise Failed(f"language '{block.language}' without a mark, expected sh, text, toml, python, c or cpp")
        return attempt(block)

    def command(self, text, expected="0"):
        ran = self.shell.run(text)
        self.printed += ran.stdout
        if str(ran.returncode) not in expected.split(" or "):
            raise Failed(f"exit code {ran.returncode}, expected {expected}\n{ran.stdout}")

    def sh(self, block):
        if IN_REAL_TIME.search(block.text) and " or " not in block.marks.get("exit", "0"):
            raise Failed("a test in real time fails on a busy host: expected --clock virtual, or the mark 'exit: 0 or 1'")
        if "fresh" in block.marks:
            self.printed = ""
        self.command(block.text, block.marks.get("exit", "0"))
        return "run"

    def output(self, block):
        """Each line has been printed; … stands for any text."""
        if "picture" in block.marks:
            return "checked"
        lines = [" ".join(line.split()) for line in self.printed.splitlines()]
        for line in filter(None, (" ".join(line.split()) for line in block.text.splitlines())):
            pattern = re.compile(".*".join(re.escape(part) for part in line.split("…")))
            if not any(pattern.search(found) for found in lines):
                raise Failed(f"'{line}' was not printed, but\n{self.printed}")
        return "checked"

    def toml(self, block):
        """A whole file, or a part that is put into one, accepted by rths check."""
        folder, text = self.shell.folder, block.text
        if "into" in block.marks or "with" in block.marks:
            base, *without = re.split(", without |, ", block.marks.get("into", ""))
            file = next((file for file in (folder / base, TREE / base) if file.is_file()), None)
            text = toml_parts.whole(file, without, [text, *block.marks.get("with", "").split(" | ")], folder)
        name = block.marks.get("file", f"block_{block.line}.toml")
        (folder / name).write_text(text)
        self.command(f"rths check {name}")
        return "checked"

    def python(self, block):
        if test := re.match(r"# (test_\w+\.py)\n", block.text):
            (self.shell.folder / test[1]).write_text(block.text)
            self.command(f"{sys.executable} -m pytest -q -p no:cacheprovider -p rths.testing {test[1]}")
            return "run"
        if "file" in block.marks:
            compile(block.text, block.place, "exec")
            return "checked"
        self.interpreter = self.interpreter or Interpreter(self.environment)
        self.printed += self.interpreter.run(block, self.shell.folder)
        return "run"

    def compiled(self, block):
        """Compiles a source; with `within` as the body of a function that has these variables."""
        text = block.text
        if "within" in block.marks:
            included = "".join(re.findall(r"^#include.*\n", text, re.MULTILINE))
            text = f"{included}void page() {{\n{block.marks['within']}\n{re.sub(r'#include.*', '', text)}}}\n"
        flags = sorted({flag for entry in json.loads((self.options.build / "compile_commands.json").read_text())
                        for flag in re.findall(r"(?:-I|-isystem )/\S+", entry["command"])})
        compiler, suffix = (["cc", "-std=c11"], ".c") if block.language == "c" else (["c++", "-std=c++20"], ".cpp")
        flags = [flag for flag in flags if not flag.endswith("/usr/include")]
        source = self.shell.folder / f"block_{block.line}{suffix}"
        source.write_text(text)
        ran = subprocess.run([*compiler, "-fsyntax-only", *" ".join(flags).split(), source], capture_output=True, text=True)
        if ran.returncode != 0:
            raise Failed(ran.stderr)
        return "checked"

    def excerpt(self, block):
        """The block is part of a file; of a diff, the added lines are."""
        file = TREE / block.marks["part of"]
        content = file.read_text()
        wanted = block.text
        parts = re.findall(r"^\+(.*)\n", wanted, re.MULTILINE) if block.language == "diff" else [wanted]
        for part in parts:
            if part not in content:
                raise Failed(f"this is not in {file.relative_to(TREE)}:\n{part}")
        return "checked"


def links_of(page):
    """Troubles with the links of a page to files and headings of the project."""
    text = re.sub(r"^```.*?^```$|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, heading = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            yield f"link to {target}: no such file"
        elif heading and file.suffix == ".md" and heading not in headings_of(file):
            yield f"link to {target}: no such heading"


def headings_of(page):
    """The anchors of the headings of a page, as GitHub makes them."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    found = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()).replace(" ", "-") for title in found}


def try_page(page, options, here, counts):
    """Tries one page; returns its troubles."""
    blocks = list(blocks_of(page))
    if options.long and not any("long" in block.marks for block in blocks):
        return []
    troubles = [f"{shown(page)}: {trouble}" for trouble in links_of(page)]
    troubles += [f"{shown(page)}: {found[0].strip()}: a command or code without a fence"
                 for found in UNFENCED.finditer(re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL))]
    with tempfile.TemporaryDirectory() as folder:
        trial = Page(options, here, options.folder or pathlib.Path(folder))
        for block in blocks:
            try:
                counts[trial.attempt(block)] += 1
            except Excused as reason:
                counts["excused"] += 1
                print(f"{block.place}: excused: {reason}", flush=True)
            except (Failed, subprocess.TimeoutExpired, OSError, KeyError, ValueError) as trouble:
                counts["failed"] += 1
                troubles.append(f"{block.place}: {trouble if isinstance(trouble, Failed) else repr(trouble)}")
        trial.close()
    return troubles


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=lambda name: pathlib.Path(name).resolve(), help="a build tree with bin/rths")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--prefix", type=lambda name: pathlib.Path(name).resolve(), help="an installed package")
    parser.add_argument("--folder", type=lambda name: pathlib.Path(name).resolve(), help="of the blocks of one page, is kept")
    parser.add_argument("pages", nargs="*")
    options = parser.parse_intermixed_args()
    here = needs(options.build, options.prefix)
    counts, troubles, tried = collections.Counter(), [], 0
    for page in pages(options.pages):
        found = try_page(page, options, here, counts)
        for trouble in found:
            print(trouble, flush=True)
        troubles += found
        tried += 1
    print(f"{sum(counts.values())} blocks on {tried} pages: {counts['run']} run, {counts['checked']} checked, "
          f"{counts['excused']} excused, {counts['failed']} failed; {len(troubles)} troubles")
    return 1 if troubles or tried == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

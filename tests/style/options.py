#!/usr/bin/env python3
"""Checks that the command accepts every option of it that a page shows.

    tests/style/options.py RTHS

Looks at lines of code, and code within sentences, that begin with `rths`, `./lab rths` or a path that ends in `/rths`.
Prints page, line, option and subcommand of each option that `rths SUBCOMMAND --help` does not list, and exits with 1 if
there is one. Standard library only.
"""
import argparse
import functools
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
CALL = re.compile(r"(?:^|[`$(|;&]|&&|(?<=\s))\s*(?:\./lab rths|(?:[\w./$-]*/)?rths)((?:[ ]+[^`|;&#\n]+)?)")
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*|(?<![\w-])-[A-Za-z](?![\w-])")


class Command:
    def __init__(self, program):
        self.program = program

    @functools.lru_cache(maxsize=None)
    def help_of(self, words):
        return subprocess.run([self.program, *words, "--help"], capture_output=True, text=True, check=True).stdout

    def subcommand_of(self, words):
        """The leading words that name a subcommand."""
        known = ()
        for word in words:
            listed = self.help_of(known).partition("Subcommands:")[2]
            if not re.search(rf"^  {re.escape(word)}\s", listed, re.MULTILINE):
                break
            known += (word,)
        return known

    def unknown_options(self, call):
        """Pairs of subcommand and option that its help does not list."""
        words = self.subcommand_of(call.replace("[", " ").split())
        listed = set(re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", self.help_of(words)))
        return [(" ".join(("rths", *words)), option) for option in OPTION.findall(call) if option not in listed]


def calls_of(page):
    """Line number and arguments of each call of the command: lines of code, and code within sentences."""
    fenced = False
    continued = ""
    for number, line in enumerate(page.splitlines(), 1):
        if line.lstrip().startswith(("```", "~~~")):
            fenced, continued = not fenced, ""
            continue
        if fenced:
            line = continued + line
            continued = line[:-1] if line.endswith("\\") else ""
            codes = [] if continued else [line]
        else:
            codes = re.findall(r"`([^`\n]+)`", line)
        for code in codes:
            for call in CALL.finditer(code):
                yield number, call[1]


def problems_of(page, command):
    return [f"{number}: {subcommand} has no {option}" for number, call in calls_of(page)
            for subcommand, option in command.unknown_options(call)]


def pages():
    listing = subprocess.run(["git", "-c", f"safe.directory={TREE}", "ls-files", "*.md"],
                             cwd=TREE, capture_output=True, text=True, check=True)
    return [TREE / name for name in listing.stdout.splitlines()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("rths")
    command = Command(parser.parse_args().rths)
    calls, problems = 0, []
    for page in pages():
        text = page.read_text(encoding="utf-8")
        calls += sum(1 for _ in calls_of(text))
        problems += [f"{page.relative_to(TREE)}:{problem}" for problem in problems_of(text, command)]
    print("\n".join(problems + [f"{calls} calls of rths, {len(problems)} options unknown"]))
    return 1 if problems or calls == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

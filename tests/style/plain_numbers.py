#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds functions whose result depends on the locale: libraries of this project work in programs with any locale.

    tests/style/plain_numbers.py

Numbers are read by `number_of` of rths/core/text.hpp, which also judges letters, and written by fmt.
Exits with 1 and prints the places if it finds others. Standard library only.
"""
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
# Programs of examples and benchmarks keep their own locale.
FOLDERS = ("adapters", "app", "broker", "commissioning", "controller", "core", "diagnosis", "launch", "maths", "memmap",
           "monitor", "python", "recording", "report", "sim", "testkit")
FORBIDDEN = {
    r"\b(strto(d|f|ld)|sto(d|f|ld)|atof)\s*\(": "number_of",
    r"\b\w*(printf|scanf)\s*\([^;]*%[-+ #0-9.*]*(l|L)?[aAeEfFgG]": "fmt::format or number_of",
    r"\b(is(alnum|alpha|blank|cntrl|digit|graph|lower|print|punct|space|upper|xdigit)|to(lower|upper))\s*\(":
        "rths/core/text.hpp",
    r"\bstd::(regex|collate|put_time|get_time|put_money|get_money|money_put)\b": "nothing that takes the global locale",
    r"\b(setlocale|locale::global)\s*\(": "nothing that changes the locale of the whole program",
    r"\{[^{}\"]*:[^{}\"]*L\}": "a format without L",
    r"\bstd::to_string\(\s*[\d.]*\.\d": "fmt::format",
}


def places():
    names = subprocess.run(["git", "-c", f"safe.directory={TREE}", "ls-files", "-co", "--exclude-standard", *FOLDERS],
                           cwd=TREE, capture_output=True, text=True, check=True).stdout.split()
    for name in names:
        if not name.endswith((".cpp", ".hpp", ".h", ".c", ".inc")):
            continue
        text = re.sub(r"//[^\n]*", "", (TREE / name).read_text(encoding="utf-8"))
        for pattern, instead in FORBIDDEN.items():
            for match in re.finditer(pattern, text):
                line = text.count("\n", 0, match.start()) + 1
                yield f"{name}:{line}: '{match[0].splitlines()[0]}' depends on the locale, expected {instead}"


found = list(places())
print("\n".join(found) or "no function depends on the locale")
sys.exit(1 if found else 0)

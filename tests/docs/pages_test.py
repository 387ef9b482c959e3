#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that pages.py finds pages that are wrong: pages_test.py BUILD."""
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FENCE = "`" * 3

WRONG = {
    "a command that fails": (f"{FENCE}sh\nfalse\n{FENCE}\n", "exit code 1"),
    "an output that is not printed": (f"{FENCE}sh\necho one\n{FENCE}\n\n{FENCE}text\ntwo\n{FENCE}\n", "'two' was not printed"),
    "a file with an unknown key": (f"{FENCE}toml\nbearing = 1\nspeed = 2\n{FENCE}\n", "speed"),
    "code that raises": (f"{FENCE}python\nraise ValueError('bad')\n{FENCE}\n", "ValueError: bad"),
    "code that does not compile": (f"{FENCE}c\nint a = ;\n{FENCE}\n", "expected expression"),
    "a test in real time": (f"{FENCE}sh\nrths run a.toml\n{FENCE}\n", "fails on a busy host"),
    "a part of no file": (f"<!-- part of: README.md -->\n{FENCE}cpp\nnowhere\n{FENCE}\n", "is not in README.md"),
    "an unknown mark": (f"<!-- maybe -->\n{FENCE}sh\ntrue\n{FENCE}\n", "unknown mark"),
    "a block without a language": (f"{FENCE}\ntrue\n{FENCE}\n", "language ''"),
    "a command without a fence": ("Text.\n\n    rths run x\n", "without a fence"),
    "a link to no file": ("[a](nowhere.md)\n", "no such file"),
    "a link to no heading": ("[a](#nowhere)\n", "no such heading"),
}
RIGHT = f"# A page\n\n[a](#a-page)\n\n{FENCE}sh\ncd /tmp\n{FENCE}\n\n{FENCE}sh\npwd\n{FENCE}\n\n{FENCE}text\n/t…p\n{FENCE}\n"


def tried(build, text):
    with tempfile.NamedTemporaryFile("w", suffix=".md") as page:
        page.write(text)
        page.flush()
        return subprocess.run([sys.executable, HERE / "pages.py", build, page.name], capture_output=True, text=True)


def main():
    build = sys.argv[1]
    wrong = []
    for name, (text, expected) in WRONG.items():
        result = tried(build, text)
        if result.returncode != 1 or expected not in result.stdout:
            wrong.append(f"{name}: expected '{expected}', found\n{result.stdout}{result.stderr}")
    result = tried(build, RIGHT)
    if result.returncode != 0 or "2 run, 1 checked" not in result.stdout:
        wrong.append(f"a page that is right: {result.stdout}{result.stderr}")
    print("\n".join(wrong + [f"{len(WRONG) + 1} pages, {len(wrong)} judged wrongly"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

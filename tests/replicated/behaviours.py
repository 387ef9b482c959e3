#!/usr/bin/env python3
"""Checks the table of the card's behaviours in docs/scramnet.md: every row has a state for each fidelity and names tests
that exist, at least one of them on a live ring if that is possible. Standard library only."""
import pathlib
import re
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
BEHAVIOURS = 52
STATES = {"exact", "approximated", "not possible"}
LIVE_STATES = {"exact", "within the scan period", "not possible"}
ROW = re.compile(r"^\| (\d+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \|$", re.MULTILINE)
REASON = re.compile(r"^- (\d+)(?:(, | to )(\d+))?: ", re.MULTILINE)
TEST = re.compile(r"\bTEST(?:_F)?\(\s*(\w+),\s*(\w+)\)")


def with_reason(page):
    """Numbers of the behaviours that the page gives a reason for."""
    numbers = set()
    for first, to, last in REASON.findall(page):
        numbers |= set(range(int(first), int(last) + 1)) if to == " to " else {int(first), int(last or first)}
    return numbers


def main():
    known = {f"{suite}.{name}" for folder in ("scramnet", "replicated")
             for file in (TREE / "tests" / folder).glob("*_test.cpp")
             for suite, name in TEST.findall(file.read_text())}
    page = (TREE / "docs/scramnet.md").read_text()
    rows = ROW.findall(page)
    wrong = []
    if [int(row[0]) for row in rows] != list(range(1, BEHAVIOURS + 1)):
        wrong.append(f"the table has the rows {[int(row[0]) for row in rows]}, expected 1 to {BEHAVIOURS}")
    impossible = {int(row[0]) for row in rows if row[4] == "not possible"}
    if impossible != with_reason(page):
        wrong.append(f"not possible live: {sorted(impossible)}, reasons: {sorted(with_reason(page))}")
    for number, _, shared, replicated, live, tests in rows:
        wrong += [f"row {number}: '{state}' is no state" for state in (shared, replicated) if state not in STATES]
        if live not in LIVE_STATES:
            wrong.append(f"row {number}: '{live}' is no state of a live ring")
        names = re.findall(r"`([^`]+)`", tests)
        if not names:
            wrong.append(f"row {number}: names no test")
        wrong += [f"row {number}: there is no test {name}" for name in names if name not in known]
        if live in LIVE_STATES and live != "not possible" and not any(name.startswith("Replicated") for name in names):
            wrong.append(f"row {number}: '{live}' on a live ring, but no test there")
    for line in wrong:
        print(line)
    print(f"{len(rows)} behaviours, {len(wrong)} mistakes")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Tests of figures.py: a changed digit of a page is found, a missing result is reported, --write fills figures in."""
import json
import os
import pathlib
import tempfile
import unittest

from figures import BINDINGS, Check, comments_in, ranges_of

RESULT = {"commit": "abc", "date": "2026-01-01", "machine": {}, "rows": [{"name": "word", "ns": 1.0461, "goal": None}]}
TABLE = """
[sources]
ring = {file = "ring.json", made_by = "a command"}
[without_results]
[[page]]
file = "page.md"
complete = "all"
all_of = ["ring.rows"]
figures = ["A word takes {ring.rows[word].ns:.2f} ns, {ring.rows[word].ns:*1e3 .0f} ps."]
[[page.rows]]
names = ["word"]
text = "| `@` | {ring.rows[@].ns:.1f} | {ring.rows[@].goal:.1f} |"
[page.constants]
"setting" = ["64 bytes"]
"""
PAGE = "A word takes 1.05 ns,\n1046 ps. With 64 bytes:\n\n| `word` | 1.0 | – |\n"


# With RTHS_LONG=1 every digit is changed, else a part of them, which is another one on each page.
STEP = 1 if os.environ.get("RTHS_LONG") else 21


class Pages(unittest.TestCase):
    """The pages of this project."""

    def test_every_changed_digit_is_found(self):
        check = Check()
        for page in check.bindings["page"]:
            with self.subTest(page=page["file"]):
                self.change_digits(check, page)

    def test_every_page_has_complete_parts(self):
        check = Check()
        for page in check.bindings["page"]:
            text = (check.root / page["file"]).read_text()
            self.assertTrue(any(character.isdecimal() for begin, end in ranges_of(text, page) for character in text[begin:end]),
                            page["file"])

    def change_digits(self, check, page):
        def problems(text):
            check.texts, check.problems = {page["file"]: text}, []
            check.check_page(page)
            return set(check.problems)
        text = (check.root / page["file"]).read_text()
        before = problems(text)
        waiting = check.unchecked[page["file"]] + comments_in(text)  # for a result that is not there
        for begin, end in ranges_of(text, page):
            for i in range(begin + len(page["file"]) % STEP, end, STEP):
                if text[i].isdecimal() and not any(first <= i < last for first, last in waiting):
                    changed = text[:i] + str((int(text[i]) + 1) % 10) + text[i + 1:]
                    self.assertTrue(problems(changed) - before, f"{text[max(0, i - 30):i + 20]!r} at {i}")


class Tree(unittest.TestCase):
    """A tree of one page and one result."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "docs").mkdir()
        self.put(BINDINGS, TABLE)
        self.put("ring.json", json.dumps(RESULT))
        self.put("page.md", PAGE)

    def put(self, name, text):
        (self.root / name).write_text(text)

    def problems(self):
        return Check(self.root).run()

    def test_accepts_pages_that_agree(self):
        self.assertEqual(self.problems(), [])

    def test_names_place_found_and_expected(self):
        self.put("page.md", PAGE.replace("1046", "1047"))
        self.assertEqual(self.problems(), ["page.md:2: found 1047, expected 1046 (ring.rows[word].ns in ring.json)"])

    def test_finds_every_changed_digit(self):
        for i, character in enumerate(PAGE):
            if character.isdecimal():
                for digit in set("0123456789") - {character}:
                    self.put("page.md", PAGE[:i] + digit + PAGE[i + 1:])
                    self.assertTrue(self.problems(), f"{digit} at {i}")

    def test_finds_a_number_that_is_not_bound(self):
        self.put("page.md", PAGE + "Ten is 10.\n")
        self.assertEqual(self.problems(), [f"page.md:5: 10 is bound to no result and is no constant in {BINDINGS}"])

    def test_finds_a_page_without_complete_parts(self):
        for changed in ('complete = []', ''):
            self.put(BINDINGS, TABLE.replace('complete = "all"', changed))
            self.assertEqual(self.problems(), [f"{BINDINGS}: page.md has no complete part"])

    def test_binds_the_sizes_of_a_test(self):
        self.put(BINDINGS, TABLE.replace("[without", 'sizes = {file = "a_test.cpp", made_by = "hand"}\n[without').replace(
            "figures = [", 'figures = ["from {sizes.late.found:*1e3 g} ms, not {sizes.late.passed:*1e3 g} ms", '))
        self.put("a_test.cpp", 'return {{"late", kForce, late, {0.003, 5e-3, 0.01}, 0.01},\n        {"dead", {kForce}, gain, 0, ""}};\n')
        self.put("page.md", PAGE + "Found from 10 ms, not 5 ms.\n")
        self.assertEqual(self.problems(), [])
        self.put("page.md", PAGE + "Found from 10 ms, not 3 ms.\n")
        self.assertEqual(self.problems(), ["page.md:5: found 3, expected 5 (sizes.late.passed in a_test.cpp)"])

    def test_finds_a_text_that_is_gone(self):
        self.put("page.md", PAGE.replace("A word", "Each word"))
        self.assertIn("has no text like: A word takes", self.problems()[0])

    def test_finds_a_row_that_is_gone(self):
        result = RESULT | {"rows": RESULT["rows"] + [{"name": "slow", "ns": 9, "goal": 1}]}
        self.put("ring.json", json.dumps(result))
        self.assertEqual(self.problems(), ["page.md: has no row `slow` of ring.rows"])

    def test_reports_a_missing_result(self):
        (self.root / "ring.json").unlink()
        self.assertEqual(self.problems(), ["ring.json: missing, 4 figures depend on it; made by: a command"])

    def test_reports_a_missing_value(self):
        self.put("ring.json", json.dumps(RESULT | {"rows": [{"name": "word", "goal": None}]}))
        self.assertIn("ring.rows[word].ns is in no result", self.problems()[0])

    def test_reports_a_result_without_commit(self):
        self.put("ring.json", json.dumps({key: value for key, value in RESULT.items() if key != "commit"}))
        self.assertEqual(self.problems(), ["ring.json: has no commit"])

    def test_reports_numbers_in_tables_of_other_pages(self):
        self.put("docs/other.md", "| a | 1 |\n")
        self.assertEqual(self.problems(), [f"docs/other.md: has numbers in tables, but neither figures nor a reason in {BINDINGS}"])

    def test_writes_results_into_pages(self):
        self.put("page.md", PAGE.replace("1.05 ns", "7 ns").replace("| 1.0 |", "| – |"))
        self.assertEqual(Check(self.root).write(), 2)
        self.assertEqual((self.root / "page.md").read_text(), PAGE)


if __name__ == "__main__":
    unittest.main()

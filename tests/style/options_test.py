"""Tests of options.py, with the help of a small command in place of the real one."""
import unittest

from options import Command, calls_of, problems_of

HELP = {
    (): "Options:\n  -h,--help\n\nSubcommands:\n  run   Run\n  bench Measure\n",
    ("run",): "Options:\n  --set TEXT\n",
    ("bench",): "Subcommands:\n  ring  Measure it\n",
    ("bench", "ring"): "Options:\n  --cycles INT\n",
}


class SmallCommand(Command):
    def __init__(self):
        super().__init__("unused")

    def help_of(self, words):
        return HELP[words]


class OptionsTest(unittest.TestCase):
    def problems(self, page):
        return problems_of(page, SmallCommand())

    def test_accepts_listed_options(self):
        self.assertEqual(self.problems("`rths run a.toml --set x=1`\n```\nrths bench ring [--cycles N]\n```\n"), [])

    def test_names_line_subcommand_and_option(self):
        self.assertEqual(self.problems("text\nsee `rths bench ring --cycle 3`"), ["2: rths bench ring has no --cycle"])

    def test_finds_every_way_to_call_the_command(self):
        for call in ("rths", "./lab rths", "build/release/bin/rths", "X=1 rths", "cd a && rths", "$P/bin/rths", "(rths"):
            with self.subTest(call):
                self.assertEqual(self.problems(f"```\n{call} run --no\n```"), ["2: rths run has no --no"])

    def test_joins_continued_lines(self):
        self.assertEqual(self.problems("```\nrths run \\\n  --no\n```"), ["3: rths run has no --no"])

    def test_ignores_other_programs_and_comments(self):
        page = "```\nrths run a | grep --count b  # --no\nls --all\n```\nthe word rths --no outside code"
        self.assertEqual(self.problems(page), [])
        self.assertEqual(len(list(calls_of(page))), 1)


if __name__ == "__main__":
    unittest.main()

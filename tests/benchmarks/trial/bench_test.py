# SPDX-License-Identifier: Apache-2.0
import argparse
import pathlib
import tempfile
import unittest

import bench


class KeepMakers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def keep(self, family):
        options = argparse.Namespace(out=self.folder / "out", rths=self.folder / "rths", family=[family])
        bench.keep_makers(options)

    def test_lets_the_same_programs_resume(self):
        (self.folder / "rths").write_text("one")
        self.keep("laboratory")
        self.keep("laboratory")

    def test_refuses_cases_of_another_command(self):
        (self.folder / "rths").write_text("one")
        self.keep("laboratory")
        (self.folder / "rths").write_text("another")
        self.keep("systems")  # its cases do not depend on the command
        with self.assertRaisesRegex(SystemExit, "made with other rths"):
            self.keep("laboratory")


class Plan(unittest.TestCase):
    def test_families_of_little_time_have_several_cases_a_turn(self):
        plan = bench.planned(argparse.Namespace(family=["own", "systems"], cases=7))
        self.assertEqual(plan, [("own", 0), ("systems", 0), ("systems", 1), ("own", 1), ("systems", 2), ("systems", 3), ("own", 2)])


if __name__ == "__main__":
    unittest.main()

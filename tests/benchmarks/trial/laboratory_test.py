# SPDX-License-Identifier: Apache-2.0
"""Choice and run of cases."""
import json
import pathlib
import signal
import tempfile
import unittest
import unittest.mock

import laboratory

TOOL = """#!/usr/bin/env python3
import json, pathlib, sys
case, out = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[4])
seen = sorted(file.name for file in case.parent.iterdir())
(out / "verdict.json").write_text(json.dumps({"seen": seen, "arguments": sys.argv[1:]}))
counter = pathlib.Path(__file__).parent / "runs"
counter.write_text(str(int(counter.read_text()) + 1 if counter.exists() else 1))
"""


class Laboratory(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        root = pathlib.Path(self.folder.name)
        self.tool, self.case, self.out = root / "tool", root / "case_3", root / "out"
        self.tool.write_text(TOOL)
        self.tool.chmod(0o755)
        self.case.mkdir()
        (self.case / "case.toml").write_text("format = 1")
        (root / "answers").mkdir()

    def diagnose(self):
        return laboratory.diagnose(self.tool, self.case, self.out, laboratory.cores()[0])

    def test_the_tool_sees_nothing_beside_its_case(self):
        result = self.diagnose()
        self.assertEqual(result["verdict"]["seen"], ["case_3", "log.txt", "verdict"])
        self.assertNotIn(self.folder.name, " ".join(result["verdict"]["arguments"]))
        self.assertEqual(result["status"], 0)
        self.assertGreater(result["cpu_s"], 0)

    def test_a_case_is_run_again_only_if_tool_or_case_changed(self):
        runs = self.tool.parent / "runs"
        for _ in range(2):
            self.diagnose()
        self.assertEqual(runs.read_text(), "1")
        (self.case / "case.toml").write_text("format = 2")
        self.diagnose()
        self.tool.write_text(TOOL + "#")
        self.diagnose()
        self.assertEqual(runs.read_text(), "3")

    def test_a_tool_has_a_limit_of_processor_time(self):
        self.tool.write_text("#!/usr/bin/env python3\nwhile True: pass\n")
        with unittest.mock.patch.object(laboratory, "LIMIT_S", 1):
            result = self.diagnose()
        self.assertEqual((result["status"], result["verdict"]), (-signal.SIGXCPU, None))
        self.assertAlmostEqual(result["cpu_s"], 1, delta=0.5)

    def test_a_tool_that_fails_leaves_no_verdict(self):
        self.tool.write_text("#!/bin/sh\nexit 3\n")
        result = self.diagnose()
        self.assertEqual((result["status"], result["verdict"]), (3, None))
        self.assertTrue(json.loads((self.out / "run.json").read_text()))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
import unittest

from peers import is_in_library

KNOWN = {("cubic_stiffness", "spring.1"), ("saturation", "input.u"), ("loadcell_gain", None)}


class IsInLibrary(unittest.TestCase):
    def test_needs_the_component(self):
        self.assertTrue(is_in_library({"name": "cubic_stiffness", "component": "spring.1"}, KNOWN))
        self.assertFalse(is_in_library({"name": "cubic_stiffness", "component": "spring.2"}, KNOWN))
        self.assertFalse(is_in_library({"name": "saturation", "component": "output.y1"}, KNOWN))

    def test_needs_the_name_alone_without_a_component(self):
        self.assertTrue(is_in_library({"name": "force_gain"}, KNOWN))
        self.assertFalse(is_in_library({"name": "lead_heating"}, KNOWN))

    def test_accepts_another_right_name(self):
        self.assertTrue(is_in_library({"name": "scale", "also": ["force_gain"]}, KNOWN))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""Faults that no verdict may have."""
import copy
import unittest

import sentences

PARAMETER = {"value": 400.0, "ci95": [390.0, 410.0], "unit": "N", "absent": 0.0}
GOOD = {
    "verdict": "missing", "confidence": 0.93,
    "sentence": "Missing: dry friction (machine, friction force 400 ± 10 N), confidence 0.93; on the unseen record unseen.csv the error "
                "falls from 9.1 % to 0.63 % (99.8 % of the unexplained energy); what is left is 1.3 times the sensors' noise.",
    "causes": [{"name": "coulomb_friction", "is_rule": False, "part": "machine", "channel": "force", "explained_fraction": 0.998,
                "parameters": {"coulomb_friction.friction_force": PARAMETER}}],
    "fit": {"fit.csv": {"use": "fit", "nrmse_before": 0.08, "nrmse_after": 0.006},
            "unseen.csv": {"use": "held_out", "nrmse_before": 0.0911, "nrmse_after": 0.0063}},
    "proof": {"nrmse_before": 0.0911, "nrmse_after": 0.0063, "explained_fraction": 0.998, "times_noise": 1.31},
    "relations": [{"name": "motion to force", "verdict": "missing", "causes": ["coulomb_friction"]}]}


class Faults(unittest.TestCase):
    def setUp(self):
        self.verdict = copy.deepcopy(GOOD)
        self.cause = self.verdict["causes"][0]
        self.size = self.cause["parameters"]["coulomb_friction.friction_force"]

    def only(self):
        faults = sentences.faults_of(self.verdict, {"force.long": "N"})
        self.assertEqual(len(faults), 1, faults)
        return faults[0]

    def test_a_good_verdict_has_none(self):
        self.assertEqual(sentences.faults_of(GOOD, {"force.long": "N"}), [])

    def test_no_share_exceeds_the_whole(self):
        self.verdict["sentence"] = GOOD["sentence"].replace("99.8", "372")
        self.assertIn("372", self.only())

    def test_no_number_has_two_values(self):
        for one, other in (("to 0.63 %", "to 0.67 %"), ("confidence 0.93", "confidence 1.00"), ("left is 1.3", "left is 11")):
            self.verdict["sentence"] = GOOD["sentence"].replace(one, other)
            self.only()

    def test_no_cause_has_the_size_zero(self):
        self.size["value"], self.size["ci95"] = 0.5, [-25, 25.5]
        self.assertIn("may have no size", self.only())

    def test_no_size_lies_on_its_bound(self):
        self.size["ci95"] = [390.0, 400.0]
        self.assertIn("on its bound", self.only())

    def test_a_limit_of_a_sensor_has_the_unit_of_its_channel(self):
        self.cause["part"] = "sensor"
        self.cause["parameters"] = {"force_saturation.limit": PARAMETER | {"unit": "m", "absent": None}}
        self.assertIn("its channel in N", self.only())

    def test_every_relation_agrees_with_its_causes(self):
        self.verdict["relations"][0]["verdict"] = "none"
        self.assertIn("motion to force", self.only())


if __name__ == "__main__":
    unittest.main()

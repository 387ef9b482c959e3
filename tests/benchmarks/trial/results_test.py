# SPDX-License-Identifier: Apache-2.0
"""Counts of the result file."""
import unittest

import results
from by_hand import answer, cause, effect, verdict
from judge import judge


def judged(said, *effects, kind="library", **more):
    return judge(said, answer(*effects, kind=kind) | {"family": "own", "tier": "standard"}) | {"cpu_s": 2} | more


class Counts(unittest.TestCase):
    """One case of each kind, each with a right verdict."""

    def setUp(self):
        damage = {"form": "change of strength at a time"}
        named = verdict("missing", cause("p_delta"))
        self.rows = [
            judged(named, effect("p_delta"), cpu_s=4),
            judged(named, effect("scragging")),
            judged(named, effect("cubic_stiffness", detectable=False)),
            judged(verdict("missing", cause("p_delta"), cause("scragging")), effect("p_delta"), effect("scragging"), kind="pair"),
            judged(verdict("unknown"), effect("damage_step") | damage, kind="outside"),
            judged(verdict("none"), kind="none"),
            judged(verdict("missing", cause("p_delta")), kind="none"),
        ]
        self.found = results.summary(self.rows)

    def counts(self, key):
        return self.found[key]["hits"], self.found[key]["of"]

    def test_names_count_detectable_effects(self):
        self.assertEqual(self.counts("named_first"), (1, 2))
        self.assertEqual(self.counts("pairs_both"), (1, 1))
        self.assertEqual(self.found["detectable"], 4)

    def test_spurious_names_count_in_every_case(self):
        self.assertAlmostEqual(self.found["spurious_per_case"], 3 / 7)

    def test_a_name_where_nothing_is_missing_is_a_false_alarm(self):
        self.assertEqual(self.counts("false_alarms"), (1, 2))
        self.assertEqual(self.found["none_cases"], 2)

    def test_a_quantity_without_a_case_is_null(self):
        nothing = results.summary([])
        self.assertIsNone(nothing["seconds_median"])
        self.assertIsNone(nothing["named_first"]["rate"])
        self.assertIsNone(nothing["iou"]["state"])

    def test_all_requested_quantities_are_in_every_summary(self):
        self.assertEqual(set(self.found), {
            "cases", "finished", "detectable", "named_first", "named_beside", "right_in_tie", "pairs_both", "pairs_beside",
            "spurious_per_case", "spurious_beside_per_case", "none_cases",
            "false_alarms", "outside_abstained", "form_right", "parameter_error_median", "coverage95",
            "after_over_floor_median", "after_over_floor_90", "iou", "iou_energy", "seconds_median", "reliability", "none_right", "unknown_right",
            "faulty_verdicts"})

    def test_a_bin_of_confidence_holds_if_its_mean_is_within_the_interval_of_the_right_share(self):
        named = [{"confidence": 0.97, "right": k < 48} for k in range(50)] + [{"confidence": 0.9, "right": k < 5} for k in range(20)]
        low, middle, high, top = results.reliability(named)
        self.assertEqual((low["names"], middle["holds"]), (0, None))
        self.assertEqual((high["right"], high["names"], high["holds"]), (5, 20, False))
        self.assertEqual((top["right"], top["names"], top["holds"]), (48, 50, True))

    def test_families_and_tiers_add_up(self):
        whole = results.by_family_and_tier(self.rows)
        self.assertEqual(whole["own"]["all"]["cases"], whole["own"]["standard"]["cases"])
        self.assertEqual(whole["all"]["all"]["cases"], 7)


if __name__ == "__main__":
    unittest.main()

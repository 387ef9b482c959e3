# SPDX-License-Identifier: Apache-2.0
"""Counts of the score table and their required values."""
import unittest

import chance
import table
from by_hand import answer, cause, effect, verdict
from judge import judge


class Chance(unittest.TestCase):
    def test_wilson_gives_the_published_intervals(self):
        # Brown, Cai & DasGupta 2001 and Newcombe 1998: 81 of 263, and the closed form z²/(n + z²).
        self.assertAlmostEqual(chance.wilson(81, 263)[0], 0.2553, places=4)
        self.assertAlmostEqual(chance.wilson(81, 263)[1], 0.3662, places=4)
        square = chance.Z95**2
        self.assertAlmostEqual(chance.wilson(0, 20)[1], square / (20 + square))

    def test_fewest_is_the_tail_of_the_binomial(self):
        # P(X < 1 | 2, ½) = ¼ > 1 %; P(X < 1 | 10, ½) < 0.1 %, P(X < 2) = 11/1024 > 1 %.
        self.assertEqual(chance.fewest(2, 0.5), 0)
        self.assertEqual(chance.fewest(10, 0.5), 1)
        self.assertEqual(chance.fewest(20, 1.0), 20)
        self.assertEqual(chance.fewest(0, 0.95), 0)

    def test_a_median_is_refuted_when_hardly_any_value_is_good(self):
        def at(good, bad):
            return table.Median("", "", [0.9] * good + [0.1] * bad, 0.8, more_is_better=True)
        self.assertTrue(at(6, 5).is_met())
        self.assertFalse(at(5, 6).is_met())
        self.assertFalse(at(5, 6).is_refuted())
        self.assertTrue(at(0, 10).is_refuted())
        self.assertFalse(table.Median("", "", [0.1] * 10, 0.8).is_refuted())
        self.assertTrue(table.Median("", "", [0.9] * 10, 0.8).is_refuted())

    def test_a_rate_below_its_bar_is_missed(self):
        clear = judge(verdict("missing", cause("p_delta")), answer(effect("p_delta")))
        wrong = judge(verdict("missing", cause("scragging")), answer(effect("p_delta")))
        first = {len(rows): next(r for r in table.score(rows) if r.key == "right_first")
                 for rows in ([clear] * 19 + [wrong], [clear] * 18 + [wrong] * 3, [wrong] * 10)}
        self.assertTrue(first[20].is_met())
        self.assertFalse(first[21].is_met())
        self.assertFalse(first[21].is_refuted())
        self.assertTrue(first[10].is_refuted())

class Table(unittest.TestCase):
    """One case of each kind, each with a right verdict."""

    def setUp(self):
        def judged(name, kind="library", said=None, **more):
            return judge(said or verdict("missing", cause(name)), answer(effect(name, **more), kind=kind))
        damage = {"form": "change of strength at a time"}
        self.rows = [
            judged("p_delta"),
            judged("scragging", distinguishable=False),
            judged("cubic_stiffness", detectable=False),
            judged("accelerometer_gain", part="sensor", channel="acceleration"),
            judge(verdict("unknown"), answer(effect("damage_step") | damage, kind="outside")),
            judge(verdict("unknown"), answer(effect("gyroscopic", detectable=False) | damage, kind="outside")),
            judge(verdict("none"), answer(kind="none")),
        ]
        for row, number in zip(self.rows, (1, 2, 4, 8, 16, 32, 64)):
            row["nrmse_after"] = row["variance_after"] = number
        self.table = {row.key: row for row in table.score(self.rows)}

    def counts(self, key):
        return self.table[key].hits, self.table[key].of

    def test_names_count_detectable_and_distinguishable_effects(self):
        self.assertEqual(self.counts("right_first"), (2, 2))
        self.assertEqual(self.counts("right_in_tie"), (2, 3))
        self.assertEqual(self.counts("ties"), (0, 1))
        self.assertEqual(self.counts("right_first_all"), (4, 4))

    def test_abstentions_count_all_outsiders(self):
        self.assertEqual(self.counts("abstained"), (2, 2))
        self.assertEqual(self.counts("abstained_seen"), (1, 1))

    def test_places_count_detectable_effects(self):
        self.assertEqual(self.counts("part"), (2, 3))
        self.assertEqual(self.counts("part_all"), (3, 4))
        self.assertEqual(self.counts("channel"), (0, 1))
        self.assertEqual(len(self.table["iou_time"].values), 3)

    def test_proofs_count_named_effects(self):
        self.assertEqual(self.table["variance"].values, [1, 2, 8])
        self.assertEqual(self.table["after"].values, [1, 2])

    def test_required_values_are_those_of_the_trial(self):
        asked = {key: row.bar for key, row in self.table.items() if getattr(row, "bar", None) is not None}
        self.assertEqual(asked, {"right_first": 0.95, "silent": 1, "abstained": 0.9, "part": 0.95,
                                 "channel": 0.95, "iou_time": 0.8, "iou_frequency": 0.88,
                                 "iou_state": 0.85, "variance": 1.05, "finished": 1, "cpu_s": 5})

    def test_the_proof_is_on_the_unseen_record(self):
        fit = {"fit.csv": {"nrmse_after": 0.5}, "unseen.csv": {"nrmse_after": 0.02, "variance_after": 1.1}}
        row = judge(verdict("missing", cause("p_delta"), fit=fit), answer(effect("p_delta")))
        self.assertAlmostEqual(row["after_to_oracle"], 2)
        self.assertEqual(row["variance_after"], 1.1)


if __name__ == "__main__":
    unittest.main()

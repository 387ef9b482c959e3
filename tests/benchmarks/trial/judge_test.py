# SPDX-License-Identifier: Apache-2.0
"""Definitions of right names, ties and abstentions."""
import unittest

import results
from by_hand import answer, cause, effect, verdict
from judge import judge


class Names(unittest.TestCase):
    def test_names_of_the_catalogue_are_those_of_the_generator(self):
        for ours, theirs in [("load_dep_friction", "load_dependent_friction"),
                             ("stribeck_breakaway", "stribeck_friction"),
                             ("viscoelastic_relax", "viscoelastic_relaxation"), ("loadcell_gain", "force_gain"),
                             ("accelerometer_drift", "acceleration_drift"),
                             ("quantisation", "force_quantisation"),
                             ("crosstalk_horizontal", "force_crosstalk_horizontal"), ("clock_drift", "clock_drift"),
                             ("coulomb_friction", "coulomb_friction")]:
            row = judge(verdict("missing", cause(theirs)), answer(effect(ours)))
            self.assertTrue(row["right_first"], theirs)
            self.assertEqual(row["spurious"], [], theirs)

    def test_another_channel_is_another_name(self):
        row = judge(verdict("missing", cause("displacement_quantisation")), answer(effect("quantisation")))
        self.assertFalse(row["right_first"])
        self.assertEqual(row["spurious"], ["displacement_quantisation"])

    def test_only_the_first_cause_is_named_first(self):
        said = verdict("missing", cause("viscous_friction"), cause("coulomb_friction"))
        row = judge(said, answer(effect("coulomb_friction")))
        self.assertFalse(row["right_first"])
        self.assertEqual(row["spurious"], ["viscous_friction"])

    def test_an_unknown_names_nothing(self):
        row = judge(verdict("unknown", cause("coulomb_friction")), answer(effect("coulomb_friction")))
        self.assertFalse(row["right_first"])
        self.assertFalse(row["right_in_tie"])

    def test_a_case_without_verdict_is_wrong(self):
        row = judge(None, answer(effect("coulomb_friction")))
        self.assertEqual(row["outcome"], "failed")
        self.assertFalse(row["right_first"] or row["right_in_tie"] or row["part_right"])


class Rules(unittest.TestCase):
    """A wrong rule of hysteresis is reported beside the missing effects and is not one of their names."""
    SAID = cause("second_loop") | {"is_rule": True}

    @staticmethod
    def _answer(beta, *effects, kind="library"):
        made = answer(*effects, kind=kind)
        made["specimen"]["beta"] = {"value": beta, "absent": 0.5}
        return made

    def test_if_it_is_wrong_the_other_causes_count(self):
        said = verdict("missing", cause("coulomb_friction"), self.SAID)
        row = judge(said, self._answer(0.2, effect("coulomb_friction")))
        self.assertTrue(row["right_first"])
        self.assertEqual((row["spurious"], row["rules"]), ([], ["second_loop"]))

    def test_if_only_the_rule_is_wrong_nothing_is_missing(self):
        self.assertEqual(judge(verdict("missing", self.SAID), self._answer(0.2, kind="none"))["outcome"], "none")
        left = verdict("missing", self.SAID, remainder=True)
        self.assertEqual(judge(left, self._answer(0.2, kind="none"))["outcome"], "missing")

    def test_if_it_is_right_it_counts_as_a_name(self):
        row = judge(verdict("missing", self.SAID), self._answer(0.5, kind="none"))
        self.assertEqual((row["outcome"], row["spurious"]), ("missing", ["second_loop"]))


class Ties(unittest.TestCase):
    TIED = {"distinguishable": False, "tie": ["axial_load_stiffness"]}

    def test_an_indistinguishable_effect_must_be_reported_as_a_tie(self):
        alone = judge(verdict("missing", cause("p_delta")), answer(effect("p_delta", **self.TIED)))
        tied = judge(verdict("missing", cause("p_delta", "axial_load_stiffness")),
                     answer(effect("p_delta", **self.TIED)))
        self.assertFalse(alone["right_in_tie"])
        self.assertTrue(tied["right_in_tie"])

    def test_the_tie_holds_the_effect(self):
        behind = judge(verdict("missing", cause("axial_load_stiffness", "p_delta")),
                       answer(effect("p_delta", **self.TIED)))
        without = judge(verdict("missing", cause("axial_load_stiffness", "cubic_stiffness")),
                        answer(effect("p_delta", **self.TIED)))
        self.assertTrue(behind["right_in_tie"])
        self.assertEqual(behind["spurious"], [])
        self.assertFalse(without["right_in_tie"])
        self.assertEqual(without["spurious"], ["axial_load_stiffness"])

    def test_of_a_distinguishable_effect_a_wrong_first_name_is_spurious(self):
        row = judge(verdict("missing", cause("axial_load_stiffness", "p_delta")), answer(effect("p_delta")))
        self.assertTrue(row["right_in_tie"])
        self.assertFalse(row["right_first"])
        self.assertEqual(row["spurious"], ["axial_load_stiffness"])

    def test_ties_of_later_causes_do_not_help(self):
        said = verdict("missing", cause("coulomb_friction"), cause("scragging", "p_delta"))
        self.assertFalse(judge(said, answer(effect("p_delta")))["right_in_tie"])


class Abstention(unittest.TestCase):
    RUB = effect("local_rub") | {"form": "sgn(v) g(u)",
                                 "term_that_describes_it": "position_dependent_friction"}
    DAMAGE = effect("damage_step", part="bearing") | {"form": "change of strength at a time"}

    def judged(self, said, hidden):
        return judge(said, answer(hidden, kind="outside"))

    def test_unknown_and_remainder_are_abstentions(self):
        unknown = verdict("unknown", descriptions=[{"form": "f(v)"}])
        remainder = verdict("missing", cause("scragging"), remainder=True)
        named = verdict("missing", cause("scragging"), remainder=False)
        self.assertTrue(self.judged(unknown, self.DAMAGE)["abstained"])
        self.assertTrue(self.judged(remainder, self.DAMAGE)["abstained"])
        self.assertEqual(self.judged(remainder, self.DAMAGE)["spurious"], ["scragging"])
        self.assertFalse(self.judged(named, self.DAMAGE)["abstained"])
        self.assertFalse(self.judged(verdict("none"), self.DAMAGE)["abstained"])
        self.assertFalse(self.judged(verdict("none", remainder=True), self.DAMAGE)["abstained"])

    def test_a_term_that_describes_it_is_right(self):
        row = self.judged(verdict("missing", cause("position_dependent_friction")), self.RUB)
        self.assertTrue(row["abstained"] and row["form_right"])
        self.assertEqual(row["spurious"], [])

    def test_the_first_form_counts(self):
        right = verdict("unknown", descriptions=[{"form": "sgn(v)g(u)"}, {"form": "f(v)"}])
        second = verdict("unknown", descriptions=[{"form": "f(v)"}, {"form": "sgn(v) g(u)"}])
        self.assertTrue(self.judged(right, self.RUB)["form_right"])
        self.assertFalse(self.judged(second, self.RUB)["form_right"])

    def test_a_form_at_another_place_is_wrong(self):
        cogging = effect("cogging", part="structure") | {"form": "periodic in displacement", "component": "spring.2"}
        for place, is_right in (("masses 1 and 2", True), ("mass 1 and the ground", False)):
            said = verdict("unknown", descriptions=[{"form": f"periodic in displacement between {place}"}])
            self.assertEqual(self.judged(said, cogging)["form_right"], is_right, place)

    def test_any_other_verdict_is_a_false_alarm_if_nothing_is_missing(self):
        rows = [judge(said, answer(kind="none")) for said in
                (verdict("none"), verdict("unknown"), verdict("missing", cause("p_delta")), None)]
        self.assertEqual([results.is_right(row) for row in rows], [True, False, False, False])


class Components(unittest.TestCase):
    def test_a_name_in_another_component_is_wrong(self):
        hidden = effect("cubic_stiffness") | {"component": "spring.2"}
        there = cause("cubic_stiffness") | {"channel": "spring.2"}
        elsewhere = cause("cubic_stiffness") | {"channel": "spring.1"}
        self.assertTrue(judge(verdict("missing", there), answer(hidden))["right_first"])
        self.assertFalse(judge(verdict("missing", elsewhere), answer(hidden))["right_first"])
        self.assertEqual(judge(verdict("missing", elsewhere), answer(hidden))["spurious"], ["cubic_stiffness"])


class Pairs(unittest.TestCase):
    def test_a_pair_is_named_if_both_are(self):
        both = answer(effect("p_delta"), effect("scragging"), kind="pair")
        one = judge(verdict("missing", cause("p_delta"), cause("cubic_stiffness")), both)
        other = judge(verdict("missing", cause("scragging")), both)
        two = judge(verdict("missing", cause("scragging"), cause("p_delta")), both)
        self.assertEqual([row["all_named"] for row in (one, other, two)], [False, False, True])
        self.assertEqual(one["spurious"], ["cubic_stiffness"])

    def test_an_indistinguishable_effect_of_a_pair_may_be_in_a_tie(self):
        said = verdict("missing", cause("scragging"), cause("cubic_stiffness", "p_delta"))
        clear = answer(effect("p_delta"), effect("scragging"), kind="pair")
        alike = answer(effect("p_delta", distinguishable=False), effect("scragging"), kind="pair")
        self.assertFalse(judge(said, clear)["all_named"])
        self.assertTrue(judge(said, alike)["all_named"])


class Raw(unittest.TestCase):
    def test_an_effect_beside_an_unknown_remainder_is_named_where_more_is_missing(self):
        said = verdict("unknown", cause("p_delta"))
        self.assertTrue(judge(said, answer(effect("p_delta")) | {"tier": "raw"})["right_first"])
        self.assertFalse(judge(said, answer(effect("p_delta")) | {"tier": "standard"})["right_first"])
        self.assertFalse(judge(verdict("unknown"), answer(effect("p_delta")) | {"tier": "raw"})["right_first"])

    @staticmethod
    def _sized(name, size):
        return cause(name, parameters={f"{name}.size": {"value": size, "unit": "N"}})

    def _beside(self, *control):
        hidden = answer(effect("p_delta")) | {"tier": "raw"}
        said = verdict("unknown", self._sized("stribeck_friction", 10), self._sized("p_delta", 3))
        return judge(said, hidden, verdict("unknown", *control))

    def test_a_cause_that_the_control_has_too_is_of_the_recording(self):
        row = self._beside(self._sized("stribeck_friction", 9))
        self.assertEqual(row["of_recording"], ["stribeck_friction"])
        self.assertFalse(row["right_first"])
        self.assertEqual(row["spurious"], ["stribeck_friction"])
        self.assertTrue(row["right_first_beside"])
        self.assertEqual(row["spurious_beside"], [])

    def test_a_cause_of_another_size_is_not_of_the_recording(self):
        for size in (1, -10, 30):
            row = self._beside(self._sized("stribeck_friction", size))
            self.assertEqual((row["of_recording"], row["spurious_beside"]), ([], ["stribeck_friction"]))
            self.assertFalse(row["right_first_beside"])

    def test_an_effect_that_the_control_has_too_is_not_named(self):
        row = self._beside(self._sized("stribeck_friction", 9), self._sized("p_delta", 3))
        self.assertFalse(row["right_first_beside"])


if __name__ == "__main__":
    unittest.main()

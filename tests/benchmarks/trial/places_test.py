# SPDX-License-Identifier: Apache-2.0
"""Comparison of places and sizes with the truth."""
import pathlib
import unittest

import places
import sizes
from by_hand import CELLS, PLACE, WHERE, answer, cause, effect, parameters, verdict
from judge import judge


class Places(unittest.TestCase):
    def test_a_set_of_its_own_cells_is_the_set(self):
        said = places.compare(WHERE, PLACE, CELLS)
        self.assertEqual(said, {"time": 1, "frequency": 1, "state": 1})

    def test_the_place_after_nuisances_counts(self):
        row = judge(verdict("missing"), answer(effect("coulomb_friction")))
        self.assertEqual(row["iou"], {"time": 1, "frequency": 1, "state": 1})
        self.assertEqual(row["iou_effect"], {"time": 0.5, "frequency": 0, "state": 0.5})

    def test_overlap_is_intersection_over_union(self):
        self.assertEqual(places.time_cells([[1.0, 2.5]], 0.5), {2, 3, 4})
        self.assertAlmostEqual(places.overlap({2, 3, 4}, [2, 3]), 2 / 3)
        self.assertEqual(places.overlap(set(), [2]), 0)
        self.assertIsNone(places.overlap(set(), []))

    def test_a_cell_counts_if_half_of_it_is_covered(self):
        self.assertEqual(places.time_cells([[0.24, 0.76]], 0.5), {0, 1})
        self.assertEqual(places.time_cells([[0.26, 0.74]], 0.5), set())
        self.assertEqual(places.frequency_cells([[2.9, 5.9]], CELLS["frequency_edges_Hz"]), {2})

    def test_ranges_that_overlap_are_not_counted_twice(self):
        self.assertEqual(places.time_cells([[0.0, 0.2], [0.1, 0.2]], 0.5), set())
        self.assertEqual(places.time_cells([[0.0, 0.15], [0.35, 0.5]], 0.5), {0})

    def test_cells_of_state_run_along_velocity_first(self):
        fast = {"displacement_m": [-0.3, -0.1], "velocity_m_per_s": [0.2, 0.6]}
        self.assertEqual(places.state_cells([fast], CELLS), {2})
        self.assertEqual(places.state_cells([], CELLS), set())

    def test_a_range_may_be_open(self):
        outermost = {"displacement_m": [0.1, None], "velocity_m_per_s": [None, -0.2]}
        self.assertEqual(places.state_cells([outermost], CELLS), {6})
        self.assertEqual(places.frequency_cells([[4.0, None]], CELLS["frequency_edges_Hz"]), {3})

    def test_times_of_another_record_are_no_place(self):
        elsewhere = WHERE | {"record": "second.csv"}
        row = judge(verdict("missing", cause("coulomb_friction")) | {"where": elsewhere},
                    answer(effect("coulomb_friction")))
        self.assertEqual(row["iou"], {"time": 0, "frequency": 1, "state": 1})

    def test_part_and_channel_are_those_of_the_verdict(self):
        right = judge(verdict("missing"), answer(effect("coulomb_friction")))
        wrong = judge(verdict("missing"), answer(effect("accelerometer_gain", "sensor", "acceleration")))
        self.assertTrue(right["part_right"] and right["channel_right"])
        self.assertFalse(wrong["part_right"] or wrong["channel_right"])


class Sizes(unittest.TestCase):
    def compared(self, hidden, said):
        return sizes.compare(hidden, answer(hidden), {"parameters": said})

    def test_error_is_relative_and_axes_are_kept_apart(self):
        hidden = effect("coulomb_friction",
                        parameters=parameters(friction_long=10e3, friction_lat=5e3, presliding=1e-4))
        said = {"coulomb_friction_lat.friction_force": {"value": 5.5e3, "ci95": [5.2e3, 5.8e3]},
                "coulomb_friction_long.friction_force": {"value": 10e3, "ci95": [9e3, 11e3]}}
        long, lat = self.compared(hidden, said)
        self.assertAlmostEqual(long["error"], 0)
        self.assertAlmostEqual(lat["error"], 0.1)
        self.assertEqual((long["covered"], lat["covered"]), (True, False))

    def test_error_of_a_gain_is_that_of_its_deviation_from_one(self):
        hidden = effect("loadcell_gain", parameters=parameters(gain_error_long=0.02, gain_error_lat=0.01))
        (row,) = self.compared(hidden, {"force_gain_long.factor": {"value": 1.03, "ci95": None}})
        self.assertAlmostEqual(row["error"], 0.5)
        self.assertIsNone(row["covered"])
        (row,) = self.compared(hidden, {"force_gain_long.factor": {"value": 1.03, "ci95": [1, None]}})
        self.assertIsNone(row["covered"])
        self.assertEqual(self.compared(hidden, {"force_gain_long.factor": {"value": None}}), [])

    def test_units_of_the_generator_become_those_of_the_catalogue(self):
        hidden = effect("lead_heating", parameters=parameters(heating=0.1, cooling=0.01))
        (row,) = self.compared(hidden, {"adiabatic_heating.softening": {"value": 1e-7}})
        self.assertAlmostEqual(row["error"], 0)
        hidden = effect("p_delta", parameters=parameters(p_delta=-0.05))
        (row,) = self.compared(hidden, {"p_delta.coefficient": {"value": -0.05 * sizes.HEIGHT}})
        self.assertAlmostEqual(row["error"], 0)

    def test_friction_that_differs_forward_and_backward_has_a_mean(self):
        hidden = effect("asymmetric_friction",
                        parameters=parameters(friction_long=10e3, forward_minus_mean_long=-2e3,
                                              friction_lat=9e3, forward_minus_mean_lat=1e3))
        said = {"asymmetric_friction_long.forward_force": {"value": 8e3},
                "asymmetric_friction_long.backward_force": {"value": 12e3},
                "asymmetric_friction_lat.forward_force": {"value": 11e3}}
        self.assertEqual([round(row["error"], 6) for row in self.compared(hidden, said)], [0, 0, 0.1])

    def test_a_slower_servo_has_a_longer_time_constant(self):
        hidden = effect("actuator_bandwidth", parameters=parameters(bandwidth_factor=0.8))
        (row,) = self.compared(hidden, {"actuator_bandwidth.time_constant": {"value": sizes.SERVO_TIME * 1.25}})
        self.assertAlmostEqual(row["error"], 0)

    def test_a_cause_on_one_axis_is_compared_with_the_size_on_that_axis(self):
        hidden = effect("asymmetric_stiffness") | {"sizes": [{"name": "stiffness", "axis": "long", "value": -9e5, "absent": 0},
                                                             {"name": "stiffness", "axis": "lat", "value": 1e6, "absent": 0}]}
        said = {"title": "stiffness that differs by direction, lat axis",
                "parameters": {"asymmetric_stiffness.stiffness": {"value": 1.1e6, "ci95": [0.9e6, 1.3e6]}}}
        (row,) = sizes.compare(hidden, answer(hidden), said)
        self.assertAlmostEqual(row["error"], 0.1)
        self.assertEqual(len(sizes.compare(hidden, answer(hidden), said | {"title": "of both"})), 2)

    def test_a_gain_on_one_axis_alone_is_relative_to_the_other(self):
        hidden = effect("force_gain") | {"sizes": [{"name": "factor", "axis": "long", "value": 1.02, "absent": 1},
                                                   {"name": "factor", "axis": "lat", "value": 0.98, "absent": 1}]}
        said = {"title": "gain error of a sensor (force), lat axis",
                "parameters": {"force_gain.factor": {"value": 0.98 / 1.02, "ci95": None}}}
        (row,) = sizes.compare(hidden, answer(hidden), said)
        self.assertAlmostEqual(row["error"], 0)

    def test_sizes_of_a_wrong_name_are_not_compared(self):
        hidden = effect("scragging")
        said = cause("scragging", parameters={"scragging.virgin_excess": {"value": 2}})
        other = cause("rate_dep_strength", parameters={"scragging.virgin_excess": {"value": 2}})
        self.assertEqual(len(judge(verdict("missing", said), answer(hidden))["sizes"]), 1)
        self.assertEqual(judge(verdict("missing", other), answer(hidden))["sizes"], [])

    def test_every_size_is_a_parameter_of_the_generator(self):
        source = pathlib.Path(__file__).parents[3] / "benchmarks/diagnosis/generator/parameters.cpp"
        for size in sizes.SIZES:
            self.assertIn(f'"{size.ours}"', source.read_text())

if __name__ == "__main__":
    unittest.main()

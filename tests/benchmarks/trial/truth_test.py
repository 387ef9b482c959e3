# SPDX-License-Identifier: Apache-2.0
"""Truth and laws of the generators, against closed forms. Needs NumPy, which the trial itself needs, too."""
import unittest

try:
    import numpy as np
except ImportError as error:
    raise unittest.SkipTest("SKIPPED: this Python has no NumPy") from error

import effects
import motion
import signals
import truth
from chain import Chain
from chain_effects import INPUT, signal_effects
from systems import Placed, System
from virtual_laboratory import _term
from whitening import Whitener, basis, outside


class Whitening(unittest.TestCase):
    def test_noise_becomes_white_with_unit_variance(self):
        rng = np.random.default_rng(1)
        colour = signals.Colour(3.0)
        draws = [colour.draw(rng, 2000, 0.01)[:, None] for _ in range(40)]
        white = Whitener(draws, 0.01, 50)(colour.draw(rng, 2000, 0.01)[:, None])[:, 0]
        # Deviation of the mean of 2000 squares: √(2/2000) = 3 %; the spectrum from 40 draws adds about 2 %.
        self.assertAlmostEqual(float((white**2).mean()), 1, delta=0.12)
        self.assertLess(abs(float(np.corrcoef(white[1:], white[:-1])[0, 1])), 3 / np.sqrt(2000) + 0.03)

    def test_noise_has_its_deviation(self):
        rng = np.random.default_rng(2)
        white = signals.Colour(2.0, (1.0, 0.0, 0.0)).draw(rng, 20000, 0.1)
        self.assertAlmostEqual(float(white.std()), 2.0, delta=4 * 2.0 / np.sqrt(2 * 20000))

    def test_projection_removes_what_nuisances_reproduce(self):
        t = np.linspace(0, 1, 50)
        self.assertAlmostEqual(float(np.abs(outside(3 * t + 2, basis([t, np.ones(50)]))).max()), 0)


class Truth(unittest.TestCase):
    def setUp(self):
        self.t = np.arange(1000) * 0.01
        self.cells = truth.cells_of(10.0, 20)
        self.state = {"time": self.t, "u": None}

    def truth_of(self, effect, rivals, contains=()):
        return truth.truth_of(effect[:, None], [np.ones((1000, 1))], rivals, set(contains), self.cells, self.state)

    def test_information_is_half_the_energy_that_nuisances_leave(self):
        wave = np.sin(2 * np.pi * 3 * self.t)
        found = self.truth_of(wave + 5, {})
        self.assertAlmostEqual(found["information_nat"], 0.25 * 1000, places=6)  # ½ Σ sin² over whole periods
        self.assertTrue(found["detectable"])

    def test_a_rival_of_the_same_shape_ties_and_an_orthogonal_one_does_not(self):
        wave, other = np.sin(2 * np.pi * 3 * self.t), np.cos(2 * np.pi * 3 * self.t)
        found = self.truth_of(wave, {"same": [[2 * wave[:, None]]], "other": [[other[:, None]]]})
        self.assertEqual(found["tie"], ["same"])
        self.assertAlmostEqual(found["separation_nat"]["other"], 250, places=6)
        self.assertTrue(self.truth_of(wave, {"same": [[2 * wave[:, None]]]}, ["same"])["distinguishable"])

    def test_a_fit_of_a_nonlinear_rival_finds_its_distance(self):
        def shifted(delay):
            return np.sin(2 * np.pi * (self.t - delay))[:, None]
        rest = (shifted(0.05) - shifted(0)).ravel()
        fitted = truth.fitted_distances(rest, None, {"skew": np.array([0.03])},
                                        lambda asked: [shifted(vector[0]) - shifted(0) for _, vector in asked])
        self.assertLess(fitted["skew"], 1e-6 * truth.nats(rest))

    def test_a_rival_without_a_prediction_is_not_fitted(self):
        rest = np.sin(2 * np.pi * self.t)
        predicted = {"steady": rest[:, None], "growing": np.full((len(self.t), 1), np.inf)}
        fitted = truth.fitted_distances(rest, None, {name: np.array([1.0]) for name in predicted},
                                        lambda asked: [vector[0] * predicted[name] for name, vector in asked])
        self.assertLess(fitted["steady"], 1e-9)
        self.assertEqual(fitted["growing"], np.inf)

    def test_a_place_is_where_the_energy_is(self):
        burst = np.where((self.t >= 2) & (self.t < 3), np.sin(2 * np.pi * 5 * self.t), 0.0)
        place = truth.place_of(burst[:, None], self.cells, self.state)
        self.assertTrue(all(19 <= cell <= 30 for cell in place["time_cells"]))
        edges = self.cells["frequency_edges_Hz"]
        self.assertTrue(any(edges[cell] <= 5 <= edges[cell + 1] for cell in place["frequency_cells"]))


class Laws(unittest.TestCase):
    def test_a_phase_is_the_same_within_the_range_of_an_experiment(self):
        cogging = next(effect for effect in effects.all_effects() if effect.name == "cogging")
        for phase in (-1.0, 3.1, 3.6, 6.0):
            written = _term(cogging, {"phase": phase})[2]["phase_rad"]
            self.assertLessEqual(abs(written), np.pi)
            self.assertAlmostEqual(float(np.sin(written)), float(np.sin(phase)))

    def test_presliding_follows_the_closed_form(self):
        u = np.linspace(0, 0.01, 101)[:, None]
        self.assertTrue(np.allclose(motion.presliding(u, 0.002), 1 - np.exp(-u / 0.002)))

    def test_play_keeps_half_a_gap(self):
        u = np.concatenate([np.linspace(0, 1, 11), np.linspace(1, 0, 11)])[:, None]
        y = motion.play(u, 0.4)
        self.assertAlmostEqual(float(y[10, 0]), 0.8)
        self.assertAlmostEqual(float(y[-1, 0]), 0.2)

    def test_a_stiffening_has_the_law_of_a_stop_on_one_axis_alone(self):
        def names(axes):
            rest = np.zeros((4, axes))
            shown = effects.usable(motion.Motion(.01, rest, rest, rest, None, rest))
            return next(effect.also for effect in shown if effect.name == "large_strain_stiffening")
        self.assertEqual(names(1), ("gap_contact",))
        self.assertEqual(names(2), ())

    def test_bouc_wen_on_one_axis_is_a_hyperbolic_tangent(self):
        # dz = (1 − z²) du/u_y from rest gives z = tanh(u/u_y), with exponent 2.
        u = np.linspace(0, 0.02, 401)[:, None]
        self.assertTrue(np.allclose(motion.bouc_wen(u, 0.01), np.tanh(u / 0.01), atol=1e-5))

    def test_sliding_stays_on_the_unit_circle_and_opposes_no_motion(self):
        angle = np.linspace(0, 2 * np.pi, 500)
        z = motion.sliding(np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.001)
        self.assertTrue(np.allclose((z[10:]**2).sum(axis=1), 1))
        self.assertTrue(np.allclose(z[10:, 0], -np.sin(angle[10:]), atol=0.11))  # lags by up to slip over radius of a step

    def test_a_chain_vibrates_as_its_closed_form(self):
        # Undamped step response of one mass: (p/k)(1 − cos ωt), ω² = k/m.
        chain = Chain([{"masses": np.array([2.0]), "k": 8.0}], 1)
        u, _ = chain.run(np.ones((1, 299 * 4 + 1)) * 4.0, 0.01, 4, False)
        t = np.arange(300) * 0.01
        self.assertTrue(np.allclose(u[0, :, 0], 0.5 * (1 - np.cos(2 * t)), atol=1e-8))  # O(h⁴), h = 2.5 ms

    def test_an_input_is_limited_between_samples_too(self):
        limit = next(effect for effect in signal_effects() if (effect.name, effect.where) == ("saturation", INPUT))
        driven = System.driven(np.array([0.0, 2.0, 0.0]), [Placed(limit, 0, {"limit": 1.0})], 4)
        self.assertEqual(driven.tolist(), [0, 0.5, 1, 1, 1, 1, 1, 0.5, 0])

    def test_a_sine_is_delayed_by_cubic_interpolation(self):
        t = np.arange(200) * 0.01
        late = signals.delayed(np.sin(2 * np.pi * 2 * t), 0.025, 0.01)
        # Error of the interpolation: (ω h)⁴ 3/128 = 5.8e-6.
        self.assertTrue(np.allclose(late[10:-10], np.sin(2 * np.pi * 2 * (t - 0.025))[10:-10], atol=1e-5))

    def test_an_acceleration_is_right_at_ten_hertz(self):
        t, w = np.arange(0, 2, 0.005), 2 * np.pi * 10
        a = signals.rate_of(signals.rate_of(np.sin(w * t), 0.005), 0.005)
        self.assertLess(np.abs(a[8:-8] / w**2 + np.sin(w * t)[8:-8]).max(), 1e-4)

    def test_a_lag_has_the_closed_ramp_response(self):
        t = np.arange(100) * 0.01
        slow = signals.lagged(t, 0.05, 0.01)
        self.assertTrue(np.allclose(slow, t - 0.05 * (1 - np.exp(-t / 0.05)), atol=1e-12))

    def test_a_lag_shorter_than_a_sample_is_not_a_delay(self):
        t, w = np.arange(0, 8, 0.004), 2 * np.pi * 10
        slow = signals.lagged(np.sin(w * t), 0.001, 0.004)
        exact = (np.exp(1j * w * t) / (1 + 1j * w * 0.001)).imag
        self.assertLess(np.abs(slow - exact)[200:-5].max(), 1e-4)
        self.assertGreater(np.abs(np.sin(w * (t - 0.001)) - exact)[200:].max(), 1e-3)


if __name__ == "__main__":
    unittest.main()

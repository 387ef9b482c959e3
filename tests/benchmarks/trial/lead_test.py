# SPDX-License-Identifier: Apache-2.0
"""The heated lead plug against figures of docs/theory/lead_rubber.md."""
import math
import unittest
from unittest import mock

import numpy as np

import lead
from motion import Motion

STEP = 0.004
PER_KELVIN_OF_WORK = math.pi * lead.RADIUS**2 * lead.CAPACITY * lead.HEIGHT  # [J/K]


def cycles():
    t = np.arange(0, 20, STEP)
    u = np.stack([0.2 * np.sin(2 * math.pi * 0.33 * t), 0 * t], axis=1)
    return Motion(STEP, u, np.gradient(u, STEP, axis=0), u, None, u)


def heated_by(power, samples):
    """Temperature under a power [K/s] that falls with the strength."""
    rise = np.zeros(samples)
    for _ in range(20):
        heat = np.cumsum(np.broadcast_to(power, samples) * np.exp(-lead.PER_KELVIN * rise)) * STEP
        rise = lead.temperature(heat * PER_KELVIN_OF_WORK, STEP)
    return rise


class Plug(unittest.TestCase):
    SAMPLES = round(20 / STEP)

    def test_seventy_kelvin_are_seven_less_than_without_losses(self):
        power = 5.106
        self.assertAlmostEqual(heated_by(power, self.SAMPLES)[-1], 70, delta=0.2)
        bare = math.log(1 + lead.PER_KELVIN * power * 20) / lead.PER_KELVIN
        self.assertAlmostEqual(bare - 70, 7.2, delta=0.3)

    def test_it_cools_from_73_to_61_kelvin_in_40_seconds(self):
        power = np.where(np.arange(3 * self.SAMPLES) < self.SAMPLES, 5.389, 0.0)
        rise = heated_by(power, 3 * self.SAMPLES)
        self.assertAlmostEqual(rise[self.SAMPLES - 1], 73, delta=0.3)
        self.assertAlmostEqual(rise[-1], 61, delta=0.7)

    def test_without_losses_the_softening_is_the_plug_s(self):
        with mock.patch.object(lead, "CONDUCTIVITY", 0.0):
            self.assertAlmostEqual(lead.effective_softening(cycles(), 1e6, 3e-3) / lead.SOFTENING, 1, delta=2e-3)

    def test_losses_lower_the_softening(self):
        share = lead.effective_softening(cycles(), 1e6, 3e-3) / lead.SOFTENING
        self.assertTrue(0.92 < share < 0.98, share)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""Laws of OpenSees' elements, against closed forms. Needs NumPy and OpenSees, which the trial itself needs, too."""
import unittest

try:
    import numpy as np

    import opensees_bearings
except ImportError as error:
    raise unittest.SkipTest("SKIPPED: this Python has no NumPy or no OpenSees") from error


class Pendulum(unittest.TestCase):
    FRICTION, STIFFNESS, RADIUS = 0.07, 4.5e8, 2.3

    def setUp(self):
        values = {"friction_coefficient": self.FRICTION, "initial_stiffness": self.STIFFNESS,
                  "effective_radius": self.RADIUS}
        self.test = object.__new__(opensees_bearings.Test)
        self.test.specimen = opensees_bearings.Specimen("pendulum", values)
        self.test.u = np.stack([np.linspace(0, 0.12, 121), np.zeros(121)], axis=1)
        self.test.v = np.full((121, 2), [0.2, 0.0])
        self.test.load = np.full(121, opensees_bearings.LOAD)

    def test_slides_under_the_force_normal_to_its_sphere(self):
        # Slope s = u/R: F = N (s + mu), N = load + F s.
        u, force = self.test.u[20:, 0], self.test.bearing(self.test.specimen.values, {})[20:, 0]
        slope = u / self.RADIUS
        expected = opensees_bearings.LOAD * (slope + self.FRICTION) / (1 - slope * (slope + self.FRICTION))
        self.assertTrue(np.allclose(force, expected, rtol=1e-6))
        self.assertTrue(np.allclose(self.test.normal_force({})[20:], force / (slope + self.FRICTION), rtol=1e-6))

    def test_sticks_with_the_stiffness_that_the_simulation_states(self):
        table = self.test.specimen.toml(self.test.specimen.values)[1]
        of_sphere = opensees_bearings.LOAD / self.RADIUS
        force = self.test.bearing(self.test.specimen.values, {})[1, 0]  # 1 mm: less than the friction
        self.assertAlmostEqual(force / self.test.u[1, 0], table["initial_stiffness_N_per_m"] + of_sphere, delta=1e-6 * self.STIFFNESS)


if __name__ == "__main__":
    unittest.main()

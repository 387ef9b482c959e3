# SPDX-License-Identifier: Apache-2.0
"""Intervals of proportions against published values."""
import unittest

import chance


class Chance(unittest.TestCase):
    def test_wilson_gives_the_published_intervals(self):
        # Brown, Cai & DasGupta 2001 and Newcombe 1998: 81 of 263, and the closed form z²/(n + z²).
        self.assertAlmostEqual(chance.wilson(81, 263)[0], 0.2553, places=4)
        self.assertAlmostEqual(chance.wilson(81, 263)[1], 0.3662, places=4)
        square = chance.Z95**2
        self.assertAlmostEqual(chance.wilson(0, 20)[1], square / (20 + square))

    def test_quantiles_are_linear_between_order_statistics(self):
        self.assertEqual(chance.median([3, 1, 2]), 2)
        self.assertAlmostEqual(chance.quantile([0, 10], 0.9), 9)


if __name__ == "__main__":
    unittest.main()

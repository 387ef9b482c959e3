# SPDX-License-Identifier: Apache-2.0
"""The fit of the confidence, and its coefficients in the code."""
import json
import pathlib
import re
import unittest

import numpy as np

import fit_confidence
from confidence import FEATURES, features_of

ROOT = pathlib.Path(__file__).resolve().parents[3]


def name_with(right, case, **features):
    return {"case": case, "right": right, "features": dict.fromkeys(FEATURES, 0.0) | features}


class Fit(unittest.TestCase):
    def test_finds_the_share_that_is_right(self):
        rng = np.random.default_rng(1)
        names = []
        for k in range(3000):
            beside = float(k % 2)
            names.append(name_with(rng.random() < (0.5 if beside else 0.95), str(k), remainder=beside))
        stated = fit_confidence.stated(names, *fit_confidence.fitted(names))
        self.assertAlmostEqual(stated[0], 0.95, delta=0.03)
        self.assertAlmostEqual(stated[1], 0.5, delta=0.05)

    def test_no_feature_raises_the_confidence(self):
        names = [name_with(k % 4 != 0 or k % 2 == 1, str(k), rivals=float(k % 2)) for k in range(80)]
        self.assertTrue((fit_confidence.fitted(names)[1] >= 0).all())

    def test_nothing_is_sure(self):
        names = [name_with(True, str(k)) for k in range(10_000)]
        self.assertLessEqual(fit_confidence.stated(names, *fit_confidence.fitted(names))[0], fit_confidence.MOST)

    def test_a_verdict_of_an_old_format_has_no_features(self):
        self.assertIsNone(features_of({"gain_nat": 5}, None))


class Code(unittest.TestCase):
    def test_has_the_fitted_coefficients(self):
        fitted = json.loads((ROOT / "benchmarks/results/confidence.json").read_text())
        text = (ROOT / "diagnosis/verdict/src/confidence.cpp").read_text()
        in_code = {name: float(value) for name, value in re.findall(r"constexpr double k(\w+) = ([\d.]+);", text)}
        wanted = {"Intercept": fitted["intercept"], "Most": fitted["most"]}
        wanted |= {"".join(word.capitalize() for word in name.split("_")): value for name, value in fitted["coefficients"].items()}
        self.assertEqual({name: in_code.get(name) for name in wanted}, wanted)


if __name__ == "__main__":
    unittest.main()

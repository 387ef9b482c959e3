# SPDX-License-Identifier: Apache-2.0
"""How sure a name is: features of a cause, and a monotone logistic regression of the share of names that are right."""
import math

# Each feature is 0 where nothing speaks against a name, and grows with what does.
FEATURES = ("rivals", "rarely_best", "left", "remainder", "one_channel", "beside", "parts", "not_held_out", "noise_unknown")
LEAST_GAIN = 1e-3  # [nat]


def features_of(cause, relation):
    """Feature → value; None if the verdict does not tell them.

    @param relation  of the verdict that names the cause
    """
    if relation is None or cause.get("gain_nat") is None:
        return None
    return {"rivals": math.log1p(len(cause["alternatives"])), "rarely_best": 1 - cause["best_share"],
            "left": math.log1p((relation["left_nat"] or 0) / max(cause["gain_nat"], LEAST_GAIN)),
            "remainder": float(relation["remainder"]),
            "one_channel": float(relation["remainder"] and len(relation["outputs"]) == 1),
            "beside": math.log(max(1, len(relation["causes"]))),
            "parts": math.log(max(1, len(relation["causes"]))) if relation.get("common_law") else 0.0,
            "not_held_out": float(not relation["held_out"]), "noise_unknown": float(not relation["proof"]["noise_known"])}

# SPDX-License-Identifier: Apache-2.0
"""Handmade verdicts and answers for tests."""
import sizes

CELLS = {"time_s": 0.5, "frequency_edges_Hz": [0, 1, 2, 4, 8], "state_cells_per_side": 3,
         "state_displacement_m": 0.3, "state_velocity_m_per_s": 0.6}
PLACE = {"time_cells": [2, 3], "frequency_cells": [1], "state_cells": [4]}
BEFORE_REFIT = {"time_cells": [3], "frequency_cells": [3], "state_cells": [0, 4]}
WHERE = {"part": "machine", "channel": "force.long", "record": "fit.csv",
         "intervals_s": [[1.0, 2.0]], "band_Hz": [[1.0, 2.0]],
         "state": [{"displacement_m": [-0.1, 0.1], "velocity_m_per_s": [-0.2, 0.2], "share": 1}]}


def effect(name, part="machine", channel="force", parameters=None, **truth):
    known = {"information_nat": 900, "detectable": True, "distinguishable": True, "tie": [],
             "place": BEFORE_REFIT, "place_after_nuisances": PLACE}
    ones = {size.ours: {"value": 1} for size in sizes.SIZES if size.effect == name}
    return {"name": name, "part": part, "channel": channel, "parameters": parameters or ones,
            "truth": known | truth}


def answer(*effects, kind="library"):
    return {"case": 1, "seed": 5, "tier": "A", "kind": kind, "effects": list(effects), "cells": CELLS,
            "specimen": {"characteristic_strength": {"value": 1e6}},
            "nrmse_on_unseen": {"oracle": 0.01}}


def cause(name, *alternatives, parameters=None):
    return {"name": name, "alternatives": [{"name": other} for other in alternatives],
            "parameters": parameters or {}}


def verdict(outcome, *causes, **more):
    return {"verdict": outcome, "where": WHERE, "causes": list(causes), "fit": {}} | more


def parameters(**values):
    return {name: {"value": value, "unit": "-"} for name, value in values.items()}

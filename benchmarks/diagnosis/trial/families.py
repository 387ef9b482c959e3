# SPDX-License-Identifier: Apache-2.0
"""The families of the trial. Each makes a case and its answer from a seed and a number."""
import importlib

import numpy as np

import slots

ATTEMPTS = 5  # draws of a case, where a simulation of it fails


def _own(rng, number, seed, folder, sources):
    import own
    return own.make(number, seed, folder, sources)


def _opensees(rng, number, seed, folder, sources):
    import opensees_bearings
    import opensees_frames
    slot = slots.slot(number)
    kind = ("bouc_wen", "frame", "flat", "lead", "frame", "pendulum", "bouc_wen")[number % 7]
    if kind == "frame":
        answer = opensees_frames.make(rng, slot, folder, sources)
    else:
        answer = opensees_bearings.make(rng, slot, folder, sources, kind)
    return {"tier": slot.tier, "kind": slot.kind} | answer


def _systems(rng, number, seed, folder, sources):
    import systems
    slot = slots.slot(number)
    kind = "linear" if number % 4 == 2 else "mass_spring_damper"
    return {"tier": slot.tier, "kind": slot.kind} | systems.make(rng, slot, folder, sources, kind)


def _program(rng, number, seed, folder, sources):
    import program
    slot = slots.slot(number)
    return {"tier": slot.tier, "kind": slot.kind} | program.make(rng, number, slot, folder, sources)


def _made_by(module):
    """A maker whose module is imported when it makes its first case."""
    def make(rng, number, seed, folder, sources):
        return importlib.import_module(module).make(rng, number, folder, sources)
    return make


MAKERS = {"own": _own, "opensees": _opensees, "recordings": _made_by("recordings"), "laboratory": _made_by("virtual_laboratory"),
          "systems": _systems, "rows": _made_by("rows"), "outside": _made_by("outside"), "program": _program}
FAMILIES = tuple(MAKERS)
CASES_A_TURN = {"systems": 2, "rows": 5}  # of a family whose cases take little time; others have one


def name_of(family, number):
    return f"{family}-{number:03d}"


def make(family, number, seed, folder, sources):
    """Writes a case to the folder; returns its answer."""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, FAMILIES.index(family), number, attempt])
        try:
            answer = MAKERS[family](rng, number, seed, folder, sources)
        except RuntimeError as error:
            failure = error
            continue
        return {"format": 1, "case": name_of(family, number), "family": family, "seed": seed, "attempt": attempt} | {
            key: value for key, value in answer.items() if key not in ("case", "seed", "format")}
    raise failure

# SPDX-License-Identifier: Apache-2.0
"""Sliders of OpenSees along a recorded motion, run as a user's script with steps of 5 ms, and effects on their force."""
import dataclasses

import numpy as np

import effects
import ground_motions
import program_scripts
from case_folder import write_case
from force_truth import ForceTruth, force_cells, whitener_of
from motion import Motion
from opensees_bearings import LOAD, SLIDER, effect_entry
from opensees_runs import bearing_force
from signals import colour, low_passed, rate_of
from slots import REST_S, effects_for
from systems import FILES, floor_of

STEP = 0.005  # of records and of the analysis [s]
DURATION = 20.0  # [s]
DRAWS = 8
ENCODER = 1e-5  # noise of the displacement over its deviation
# Effects at the output have other names there than at a load cell.
OF_OUTPUT = {"force_skew": "time_skew"}


class Slider:
    """A flat slider or a friction pendulum, along one axis."""

    def __init__(self, values):
        self.values = values

    def element(self):
        name = ["singleFPBearing", 1, self.values["R"]] if "R" in self.values else ["flatSliderBearing", 1]
        return {"friction": [["Coulomb", 1, self.values["mu"]]],
                "element": [*name, self.values["k"], *SLIDER, "-iter", 200, 1e-6]}

    def force(self, u):
        """Samples × 1 [N], as the script computes it."""
        both = np.stack([u, np.zeros_like(u)], axis=1)
        return bearing_force(self.element(), both, rate_of(both, STEP), np.full(len(u), LOAD), STEP, (), 1)[:, :1]


def draw_slider(rng):
    values = {"mu": rng.uniform(.05, .11), "k": LOAD * rng.uniform(20, 60)}
    return Slider(values | ({"R": rng.uniform(1.8, 3)} if rng.random() < .5 else {}))


def _motion(rng, files, duration):
    both = ground_motions.platen_motion(rng, files, duration, REST_S, rng.uniform(.12, .2), STEP)
    return low_passed(both, 12.0, STEP)[:, 0]


def _along(u, force, scales=None):
    column = u[:, None]
    v = rate_of(column, STEP)
    return Motion(STEP, column, v, rate_of(v, STEP), None, force, scales)


def _library(motion):
    chosen = [effect for effect in effects.usable(motion) if effect.in_library
              and effect.name not in ("force_clock_drift", "platen_inertia")]
    return [dataclasses.replace(effect, also=(*effect.also, OF_OUTPUT.get(effect.name, effect.name.removeprefix("force_"))))
            if effect.part == "sensor" else effect for effect in chosen]


def _whole(motion, hidden, chosen, force, without=None):
    mine = [effect for effect in chosen if effect.name != without]
    for effect in sorted(mine, key=lambda one: one.part == "sensor"):
        force = force + effect.act(motion, hidden[effect.name], force)
    return force


def make(rng, slot, folder, sources):
    """Writes the case; returns its answer."""
    slider = draw_slider(rng)
    files = ground_motions.files_of(sources)
    motions = [_motion(rng, files, slot.duration(DURATION)) for _ in FILES]
    forces = [slider.force(u) for u in motions]
    base = _along(motions[0], forces[0])
    outsiders = [effect for effect in effects.usable(base) if not effect.in_library]
    chosen = effects_for(slot.kind, rng, _library(base), outsiders)
    size = slot.size * (.7 if slot.kind == "pair" else 1)
    hidden = {effect.name: effects.draw(effect, base, rng, size) for effect in chosen}
    recorded = [_whole(_along(u, force, base.peaks()), hidden, chosen, force) for u, force in zip(motions, forces)]
    noise = {"u": colour(rng, ENCODER * float(motions[0].std())), "F": colour(rng, slot.noise * float(forces[0].std()))}
    noisy = [force + noise["F"].draw(rng, len(force), STEP)[:, None] for force in recorded]
    _write(folder, slider, [u + noise["u"].draw(rng, len(u), STEP) for u in motions], noisy, rng)
    return {"effects": _truth(slider, base, hidden, chosen, noise, rng), "cells": force_cells(base),
            "specimen": {"kind": "slider"}, "nrmse_on_unseen": {"oracle": floor_of(recorded[2], noisy[2])}}


def _truth(slider, base, hidden, chosen, noise, rng):
    draws = [noise["F"].draw(rng, len(base.u), STEP)[:, None] for _ in range(DRAWS)]
    nuisances = [Slider(slider.values | {name: value * 1.01}).force(base.u[:, 0]) - base.force
                 for name, value in slider.values.items() if name != "k"]
    whitener = whitener_of(draws, STEP)
    whole = _whole(base, hidden, chosen, base.force)
    entries = []
    for effect in chosen:
        without = _whole(base, hidden, chosen, base.force, effect.name)
        truth = ForceTruth(dataclasses.replace(base, force=without), whitener, nuisances, None)
        entries.append(effect_entry(effect, hidden[effect.name],
                                    truth.of(effect.name, whole - without, effect.special_case_of, effect.also)))
    return entries


def _write(folder, slider, motions, noisy, rng):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "slider.py").write_text(program_scripts.slider(LOAD))
    stated = {name: value * (1 + (0 if name == "k" else rng.uniform(-.07, .07))) for name, value in slider.values.items()}
    tables = {file: {"t [s]": np.arange(len(u)) * STEP, "u [m]": u, "F [kN]": force[:, 0] / 1e3}
              for file, u, force in zip(FILES, motions, noisy)}
    document = {"name": "slider", "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "quiet_s": [0, REST_S - .1]}
                                             for k, file in enumerate(FILES)],
                "channels": {"time": "t [s]", "displacement": {"long": "u [m]"}, "force": {"long": "F [kN]"}},
                "model": {"kind": "opensees", "script": "slider.py", "arguments": ["{u}", "{step_s}", *(f"{{{name}}}" for name in stated)],
                          "inputs": {"displacement.long": "u"}, "outputs": {"force.long": {"file": "force.out", "column": 7}},
                          "fitted": [name for name in stated if name != "k"],
                          "parameters": {name: {"value": value} for name, value in stated.items()}}}
    write_case(folder, document, tables)

# SPDX-License-Identifier: Apache-2.0
"""Quasi-static tests whose rows have no time: a few rows in each half-cycle, laws of the path alone."""
import dataclasses
import math

import numpy as np

import effects
from case_folder import write_case
from effects import Effect, Size, shape
from force_truth import ForceTruth, force_cells, nrmse, whitener_of
from motion import Motion, presliding
from opensees_bearings import effect_entry
from slots import SLOTS, effects_for

DRAWS = 24
STEP = 1.0  # a row
FILES = ("fit.csv", "second.csv", "unseen.csv")
FINE = 25  # steps of the hysteresis per displacement of yield
LIBRARY = ("coulomb_friction", "asymmetric_friction", "position_dependent_friction", "load_dependent_friction",
           "cubic_stiffness", "asymmetric_stiffness", "large_strain_stiffening", "force_saturation")
OUTSIDE = ("cogging", "wearing_guide")


def hysteresis(u, yield_displacement):
    """z of the Bouc-Wen rule (β = γ = 1/2, exponent 2) along straight lines between rows."""
    z, out = 0.0, np.zeros_like(u)
    for k, step in enumerate(np.diff(u[:, 0]) / yield_displacement, 1):
        pieces = max(1, math.ceil(FINE * abs(step)))
        for _ in range(pieces):
            middle = z + .5 * _slope(z, step) / pieces
            z += _slope(middle, step) / pieces
        out[k] = z
    return out


def _slope(z, du):
    return du * (1 - z * z) if z * du > 0 else du


HYSTERESIS = Effect("bouc_wen", "bearing", (Size("characteristic_strength", "F", .06, .25), shape("yield_displacement", "U", .06, .2)),
                    lambda m, p, force: p["characteristic_strength"] * hysteresis(m.u, p["yield_displacement"]),
                    also=("bouc_wen_nagarajaiah", "bilinear", "iwan", "hysteresis_shape"))


def _effects(motion, is_elastic):
    """Effects of the library and outsiders of a case."""
    known = {effect.name: effect for effect in effects.usable(motion)}
    own = [known[name] for name in LIBRARY if name in known]
    return own + (3 * [HYSTERESIS] if is_elastic else []), [known[name] for name in OUTSIDE]


def protocol(rng, reach, is_short):
    """Displacement of a test with growing cycles; every reversal has a row."""
    rows, at = [0.0], 0.0
    for amplitude in reach * np.linspace(.2, 1, 3 if is_short else 5) * rng.uniform(.95, 1.05):
        for target in (amplitude, -amplitude, amplitude, -amplitude):
            count = int(rng.integers(10, 30))
            share = np.sort(rng.uniform(0, 1, count - 1))
            rows += [*(at + (target - at) * share), target]
            at = target
    return np.array(rows)[:, None]


def base_force(u, values):
    strength = values.get("characteristic_strength", 0.0)
    return values["stiffness"] * u + (strength * hysteresis(u, values["yield_displacement"]) if strength else 0)


def _draw_base(rng, is_elastic):
    force, reach = 10 ** rng.uniform(3, 6), 10 ** rng.uniform(-2.3, -.7)  # [N], [m]
    values = {"stiffness": force / reach * rng.uniform(.6, 1)}
    if not is_elastic:
        values |= {"characteristic_strength": force * rng.uniform(.3, .7), "yield_displacement": reach * rng.uniform(.05, .15)}
    return values, reach


def make(rng, number, folder, sources):
    """Writes the case; returns its answer."""
    own, is_elastic = SLOTS[number % len(SLOTS)], number % 3 != 2
    has_load = own.tier != "missing"
    values, reach = _draw_base(rng, is_elastic)
    motions = [_motion(rng, protocol(rng, reach, own.tier == "short"), values, has_load) for _ in FILES]
    scales = motions[0].peaks()
    motions = [dataclasses.replace(motion, scales=scales) for motion in motions]
    library, outsiders = _effects(motions[0], is_elastic)
    chosen = effects_for(own.kind, rng, library, outsiders)
    size = own.size * (.7 if own.kind == "pair" else 1)
    hidden = {effect.name: effects.draw(effect, motions[0], rng, size) for effect in chosen}
    clean = [_with(chosen, hidden, motion) for motion in motions]
    noise = {"u": 1e-4 * reach, "F": own.noise * float(clean[0].std())}
    recorded = [_record(motion, force, noise, rng) for motion, force in zip(motions, clean)]
    _write(folder, values, recorded, noise, has_load, rng)
    floor = nrmse(recorded[2]["F [N]"][:, None], clean[2], STEP)
    return {"tier": own.tier, "kind": own.kind, "effects": _entries(motions[0], values, chosen, hidden, noise, library, rng),
            "cells": force_cells(motions[0]), "specimen": {"kind": "elastic" if is_elastic else "hysteretic"},
            "nrmse_on_unseen": {"oracle": floor}}


def _motion(rng, u, values, has_load):
    load = 2 * values["stiffness"] * float(np.abs(u).max()) * (1 + .3 * np.interp(
        np.arange(len(u)), np.linspace(0, len(u), 9), rng.uniform(-1, 1, 9))) if has_load else None
    rate = np.gradient(u, axis=0)  # [m/row], scales of laws that no row can show
    return Motion(STEP, u, rate, np.gradient(rate, axis=0), load, base_force(u, values))


def _with(chosen, hidden, motion, without=None):
    """The force with the effects but one; those of the sensor last."""
    force = motion.force
    for effect in sorted((e for e in chosen if e.name != without), key=lambda e: e.part == "sensor"):
        force = force + effect.act(motion, hidden[effect.name], force)
    return force


def _record(motion, force, noise, rng):
    columns = {"u [m]": motion.u[:, 0] + noise["u"] * rng.standard_normal(len(motion.u)),
               "F [N]": force[:, 0] + noise["F"] * rng.standard_normal(len(motion.u))}
    return columns | ({"N [N]": motion.load} if motion.load is not None else {})


def _entries(motion, values, chosen, hidden, noise, library, rng):
    def draw():
        u = motion.u + noise["u"] * rng.standard_normal(motion.u.shape)
        return base_force(u, values) - motion.force + noise["F"] * rng.standard_normal(motion.u.shape)
    whitener = whitener_of([draw() for _ in range(DRAWS)], STEP)
    nuisances = [base_force(motion.u, values | {name: values[name] * 1.01}) - motion.force for name in values]
    rivals = list({effect.name: effect for effect in library}.values())
    entries = []
    for effect in chosen:
        without = _with(chosen, hidden, motion, effect.name)
        truth = ForceTruth(dataclasses.replace(motion, force=without), whitener, nuisances, None, rivals)
        entries.append(effect_entry(effect, hidden[effect.name], truth.of(effect.name, _with(chosen, hidden, motion) - without,
                                                                          effect.special_case_of, effect.also)))
    return entries


def _write(folder, values, recorded, noise, has_load, rng):
    stated = {name: value * (1 + rng.uniform(-.07, .07)) for name, value in values.items()}
    if "characteristic_strength" in values:
        term, table = "bouc_wen", {"axes": ["long"], "characteristic_strength_N": stated["characteristic_strength"],
                                   "post_yield_stiffness_N_per_m": stated["stiffness"],
                                   "yield_displacement_m": stated["yield_displacement"]}
        free = [f"bouc_wen.{name}" for name in ("characteristic_strength", "post_yield_stiffness", "yield_displacement")]
    else:
        term, table = "polynomial_stiffness", {"axes": ["long"], "linear_N_per_m": stated["stiffness"]}
        free = ["polynomial_stiffness.linear"]
    channels = {"time": "none", "displacement": {"long": "u [m]"}, "force": {"long": "F [N]"}}
    document = {"name": "quasi-static", "record": [{"file": file, "use": "fit" if k == 0 else "held_out"} for k, file in enumerate(FILES)],
                "channels": channels | ({"vertical_force": "N [N]"} if has_load else {}),
                "model": {"kind": "platen", "fitted": free, term: table}}
    if has_load:  # without, the noise of the rows is not known
        document["noise"] = {"displacement.long": f"{noise['u']:.6g} [m]", "force.long": f"{noise['F']:.6g} [N]"}
    write_case(folder, document, dict(zip(FILES, recorded)))

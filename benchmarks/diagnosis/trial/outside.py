# SPDX-License-Identifier: Apache-2.0
"""Laws outside the catalogue on one axis: springs, dampers and friction of shapes that no term has.

The simulation has a linear spring, a linear damper and dry friction in their place, so it is wrong in form.
"""
import dataclasses

import numpy as np

import effects
from case_folder import write_case
from effects import EITHER_SIGN, OUTSIDE, PRESLIDING, Effect, Size, shape
from force_truth import ForceTruth, force_cells, nrmse, whitener_of
from motion import Motion, presliding
from opensees_bearings import effect_entry
from signals import colour, low_passed, random_sines, rate_of, swell
from slots import REST_S, Slot, effects_for

STEP = 0.005  # [s]
DURATION = 18.0  # [s]
DRAWS = 8
MOTION_HZ = 12.0  # where the motion ends, and with it its noise
FILES = ("fit.csv", "second.csv", "unseen.csv")
KINDS = ("outside", "outside", "none", "outside", "outside", "outside", "none", "outside", "outside", "outside")
NOISY = 5  # number of the slot with much noise


def slot(number):
    place = number % len(KINDS)
    return Slot("noisy" if place == NOISY else "standard", KINDS[place])


def _law(name, form, law, *parameters, also=(), **more):
    return Effect(name, "bearing" if "u)" in form and "v" not in form else "machine", parameters,
                  lambda m, p, force: law(m, p), OUTSIDE, form, also=also, **more)


def _of_load(motion):
    return (motion.load / motion.scale("N") - 1)[:, None]


def laws():
    """Changes of the force by laws that no term of the catalogue has; `also`: terms of free shape that draw them."""
    width = shape("width", "U", .25, .5)
    return [
        _law("softening_spring", "f(u)", lambda m, p: p["stiffness"] * (p["width"] * np.tanh(m.u / p["width"]) - m.u),
             Size("stiffness", "F/U", .3, .6), width, also=("tabulated_stiffness",)),
        _law("one_sided_spring", "f(u)", lambda m, p: p["force"] * np.expm1(m.u / p["width"]) / np.exp(m.scale("U") / p["width"]),
             Size("force", "F", .15, .4, False, EITHER_SIGN), width, also=("tabulated_stiffness",)),
        _law("wavy_spring", "f(u)", lambda m, p: p["force"] * np.sin(2.2 * m.u / p["width"]),
             Size("force", "F", .04, .12, False, EITHER_SIGN), width, also=("tabulated_stiffness",)),
        _law("stepped_damper", "f(v)", lambda m, p: p["force"] * np.clip(m.v / p["velocity"] - np.sign(m.v), -1, 1) * (np.abs(m.v) > p["velocity"]),
             Size("force", "F", .06, .2), shape("velocity", "V", .15, .3), also=("tabulated_damping",)),
        _law("falling_damper", "f(v)", lambda m, p: p["force"] * m.v / p["velocity"] * np.exp(1 - np.abs(m.v) / p["velocity"]),
             Size("force", "F", .06, .2), shape("velocity", "V", .1, .25), also=("tabulated_damping",)),
        _law("shaped_friction", "sgn(v) g(u)",
             lambda m, p: p["force"] * presliding(m.u, p["presliding"]) * np.cos(1.5 * m.u / p["width"]),
             Size("force", "F", .03, .1), width, PRESLIDING, also=("tabulated_friction",)),
        _law("shaped_damper", "v g(u)", lambda m, p: p["coefficient"] * m.v * np.cos(1.5 * m.u / p["width"]),
             Size("coefficient", "F/V", .06, .2), width, also=("tabulated_viscosity",)),
        _law("load_squared_spring", "u g(N)", lambda m, p: p["stiffness"] * m.u * _of_load(m) ** 2,
             Size("stiffness", "F/U", .6, 1.5), needs="load"),
    ]


def plain(motion, values):
    """Force of the simulation's laws."""
    return (values["stiffness"] * motion.u + values["damping"] * motion.v
            + values["friction"] * presliding(motion.u, values["presliding"]))


def _draw_plain(rng):
    force, reach = 10 ** rng.uniform(2, 6), 10 ** rng.uniform(-2.5, -.7)  # [N], [m]
    rate = 2 * np.pi * rng.uniform(.5, 1.0) * reach
    return {"stiffness": force / reach * rng.uniform(.7, 1), "damping": force / rate * rng.uniform(.05, .15),
            "friction": force * rng.uniform(.03, .1), "presliding": reach * rng.uniform(.004, .01)}, reach


def _motion(rng, reach, load):
    t = np.arange(round(DURATION / STEP)) * STEP
    u = random_sines(rng, t, .2, 1.6, reach * rng.uniform(.3, .4)) * swell(t, REST_S, 1.5)
    u = low_passed(u[:, None], MOTION_HZ, STEP)
    weight = load * (1 + np.clip(random_sines(rng, t, .3, 3, .15) * swell(t, REST_S, 1), -.5, .5))
    v = rate_of(u, STEP)
    return Motion(STEP, u, v, rate_of(v, STEP), weight, np.zeros_like(u))


def make(rng, number, folder, sources):
    """Writes the case; returns its answer."""
    own = slot(number)
    values, reach = _draw_plain(rng)
    motions = [_motion(rng, reach, 5 * values["friction"] / .05) for _ in FILES]
    bases = [plain(motion, values) for motion in motions]
    motions = [dataclasses.replace(motion, force=base) for motion, base in zip(motions, bases)]
    scales = motions[0].peaks()
    motions = [dataclasses.replace(motion, scales=scales) for motion in motions]
    chosen = effects_for(own.kind, rng, [], laws())
    hidden = {effect.name: effects.draw(effect, motions[0], rng, own.size) for effect in chosen}
    clean = [base + sum(e.act(m, hidden[e.name], base) for e in chosen) for m, base in zip(motions, bases)]
    noise = {"u": colour(rng, .1 * own.noise * float(motions[0].u.std())), "F": colour(rng, own.noise * float(clean[0].std())),
             "N": colour(rng, 1e-3 * scales["N"])}
    recorded = [_record(m, force, noise, rng) for m, force in zip(motions, clean)]
    _write(folder, values, recorded, scales, rng)
    entries = _entries(motions[0], values, chosen, hidden, noise, rng)
    floor = nrmse(recorded[2]["F [N]"][:, None], clean[2], STEP)
    return {"tier": own.tier, "kind": own.kind, "effects": entries, "cells": force_cells(motions[0]),
            "specimen": {"kind": "plain"}, "nrmse_on_unseen": {"oracle": floor}}


def _record(motion, force, noise, rng):
    samples = len(motion.u)
    return {"t [s]": motion.t, "u [m]": motion.u[:, 0] + noise["u"].draw(rng, samples, STEP),
            "F [N]": force[:, 0] + noise["F"].draw(rng, samples, STEP),
            "N [N]": motion.load + noise["N"].draw(rng, samples, STEP)}


def _entries(motion, values, chosen, hidden, noise, rng):
    samples = len(motion.u)
    draws = []
    for _ in range(DRAWS):
        u = motion.u + low_passed(noise["u"].draw(rng, samples, STEP)[:, None], MOTION_HZ, STEP)
        moved = dataclasses.replace(motion, u=u, v=rate_of(u, STEP))
        draws.append(plain(moved, values) - motion.force + noise["F"].draw(rng, samples, STEP)[:, None])
    whitener = whitener_of(draws, STEP)
    nuisances = [plain(motion, values | {name: values[name] * 1.01}) - motion.force for name in values]
    truth = ForceTruth(motion, whitener, nuisances, None)
    return [effect_entry(effect, hidden[effect.name], truth.of(effect.name, effect.act(motion, hidden[effect.name], motion.force)))
            for effect in chosen]


def _write(folder, values, recorded, scales, rng):
    stated = {name: value * (1 + rng.uniform(-.07, .07)) for name, value in values.items()}
    document = {
        "name": "plain laws",
        "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "quiet_s": [0, REST_S - .1]} for k, file in enumerate(FILES)],
        "channels": {"time": "t [s]", "displacement": {"long": "u [m]"}, "force": {"long": "F [N]"}, "vertical_force": "N [N]"},
        "model": {"kind": "platen",
                  "fitted": ["polynomial_stiffness.linear", "viscous_friction.coefficient", "coulomb_friction.friction_force",
                             "coulomb_friction.presliding", "force_offset.offset"],
                  "polynomial_stiffness": {"axes": ["long"], "linear_N_per_m": stated["stiffness"]},
                  "viscous_friction": {"axes": ["long"], "coefficient_N_s_per_m": stated["damping"]},
                  "coulomb_friction": {"axes": ["long"], "friction_force_N": stated["friction"], "presliding_m": stated["presliding"]},
                  "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}},
        "map": {"displacement_m": 1.05 * scales["U"], "velocity_m_per_s": 1.05 * scales["V"]}}
    write_case(folder, document, dict(zip(FILES, recorded)))

# SPDX-License-Identifier: Apache-2.0
"""Small isolated frames of OpenSees under recorded earthquakes; the effect is off in the simulation.

A chain of masses on springs: the first spring is the isolation, the others are storeys. Effects of springs are
uniaxial materials of OpenSees; those of outputs and of the input are the trial's own.
"""
import numpy as np

import chain_effects
import ground_motions
from case_folder import write_case
from chain_effects import INPUT, OUTPUT, at_outputs
from opensees_runs import chain_response
from signals import colour, low_passed
from slots import effects_for
from systems import FILES, STEP, draw_effect, draw_system, floor_of, truth_of_chain

DURATION = 17.0  # [s]
REST_S = 2.0
FINE = 8  # steps of the analysis per recorded sample

# Effects that have a uniaxial material: name → materials from the values, the stiffness and the rest of the spring.
MATERIALS = {
    "large_strain_stiffening": lambda p: [("ElasticPPGap", p["stiffness"], 1e3 * p["stiffness"], p["onset"], 0.0),
                                          ("ElasticPPGap", p["stiffness"], -1e3 * p["stiffness"], -p["onset"], 0.0)],
    "viscoelastic_relaxation": lambda p: [("Maxwell", p["stiffness"], p["stiffness"] * p["relaxation_time"], 1.0, 1.0)],
    "bouc_wen": lambda p: [("BoucWen", 0.0, p["characteristic_strength"] / p["yield_displacement"], 2.0,
                            0.5 / p["yield_displacement"]**2, 0.5 / p["yield_displacement"]**2, 1.0, 0.0, 0.0, 0.0, 0.0)],
    "quadratic_drag": lambda p: [("Viscous", p["coefficient"], 2.0)],
    "coulomb_friction": lambda p: [("BoucWen", 0.0, p["friction_force"] / p["presliding"], 1.0,
                                    0.5 / p["presliding"], 0.5 / p["presliding"], 1.0, 0.0, 0.0, 0.0, 0.0)],
    "cubic_stiffness": lambda p: [_elastic(lambda d: p["stiffness"] * d**3, p["reach"])],
    "asymmetric_stiffness": lambda p: [_elastic(lambda d: p["stiffness"] * d * d, p["reach"])],
}


def _elastic(law, reach):
    d = np.linspace(-reach, reach, 201)
    return ("ElasticMultiLinear", "-strain", *d.tolist(), "-stress", *law(d).tolist())


def _springs(system, placed, reach):
    springs = []
    for i, (k, c) in enumerate(zip(system.k, system.c)):
        materials = [("Elastic", float(k)), ("Viscous", float(c), 1.0)]
        for one in placed:
            if one.effect.name in MATERIALS and one.at == i:
                values = {name: float(value) for name, value in one.values.items()} | {"reach": 3 * reach[i]}
                materials += MATERIALS[one.effect.name](values)
        springs.append((i, i + 1, materials))
    return springs


def respond(system, placed, ground, fine, reach=None):
    """Outputs of a frame with effects: samples × outputs.

    @param fine  steps of the analysis per sample  @param reach  largest deformations; only for effects of springs
    """
    for one in (p for p in placed if p.effect.where == INPUT):
        ground = one.effect.act(ground, one.values, STEP)
    u, _ = chain_response([float(m) for m in system.masses], _springs(system, placed, reach), ground, STEP, fine)
    y = u[:, system.outputs].copy()
    for one in at_outputs(placed):
        y[:, one.at] = one.effect.act(y[:, one.at], one.values, STEP)
    return y


def _library():
    springs = [effect for effect in chain_effects.spring_effects() if effect.name in MATERIALS]
    return springs + [effect for effect in chain_effects.signal_effects()
                      if effect.name not in ("saturation", "input_dead_zone", "absolute_value_sensor") or effect.where == OUTPUT]


def _outsiders():
    return [effect for effect in chain_effects.outsiders() if effect.where == OUTPUT]


def ground_of(rng, files, duration):
    """One component of a recorded motion, after rest [m/s²]."""
    ground = ground_motions.read(files[rng.integers(len(files))], STEP)
    ground = ground_motions.strong_part(ground, duration - REST_S, STEP)[:, rng.integers(2)]
    ground *= rng.uniform(2, 4) / np.abs(ground).max() * np.minimum(1, np.arange(len(ground)) * STEP)
    whole = np.zeros(round(duration / STEP))
    begin = round(REST_S / STEP)
    kept = low_passed(ground, 12.0, STEP)[:len(whole) - begin]
    whole[begin:begin + len(kept)] = kept
    return whole


def make(rng, slot, folder, sources):
    """Writes the case; returns its answer."""
    system = draw_system(rng, slot.tier, True)
    files = ground_motions.files_of(sources)
    grounds = [ground_of(rng, files, slot.duration(DURATION)) for _ in FILES]
    y, d, v = (x[0] for x in system.respond([grounds[0]], [system.variant()], [[]], 2))
    chosen = effects_for(slot.kind, rng, _library(), _outsiders())
    size = slot.size * (.7 if slot.kind == "pair" else 1)
    placed = [draw_effect(effect, system, (y, d, v), grounds[0], rng, size) for effect in chosen]
    reach = np.abs(d).max(axis=0)
    recorded = [respond(system, placed, ground, FINE, reach) for ground in grounds]
    noise = [colour(rng, slot.noise * float(column.std())) for column in y.T]
    noisy = [one + np.stack([n.draw(rng, len(one), STEP) for n in noise], axis=1) for one in recorded]
    _write(folder, system, grounds, noisy, rng)
    entries, cells = truth_of_chain(system, placed, grounds[0], noise, rng, "mass_spring_damper")
    return {"effects": entries, "cells": cells, "specimen": {"kind": "frame"},
            "nrmse_on_unseen": {"oracle": floor_of(recorded[2], noisy[2])}}


def _write(folder, system, grounds, noisy, rng):
    count = len(system.k)
    names = [f"y{k + 1}" for k in range(len(system.outputs))]
    tables = {file: {"t": np.arange(len(ground)) * STEP, "a": ground} | dict(zip(names, y.T))
              for file, ground, y in zip(FILES, grounds, noisy)}
    springs = [{"between": [i, i + 1], "stiffness_N_per_m": system.k[i] * (1 + rng.uniform(-.06, .06)),
                "damping_N_s_per_m": system.c[i] * (1 + rng.uniform(-.2, .2))} for i in range(count)]
    document = {"name": f"isolated frame, {count} masses",
                "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "quiet_s": [0, REST_S - .1]}
                           for k, file in enumerate(FILES)],
                "channels": {"time": "t [s]", "input": {"u": "a [m/s2]"}, "output": {name: f"{name} [m]" for name in names}},
                "model": {"kind": "mass_spring_damper", "masses_kg": system.masses,
                          "fitted": [f"spring.{i + 1}.{name}" for i in range(count) for name in ("stiffness", "damping")],
                          "inputs": {"input.u": "base_acceleration"},
                          "outputs": {f"output.{name}": f"displacement.{mass + 1}" for name, mass in zip(names, system.outputs)},
                          "spring": springs}}
    write_case(folder, document, tables)

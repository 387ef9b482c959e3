# SPDX-License-Identifier: Apache-2.0
"""Simulations of users, run as they are: frames and sliders of OpenSees as scripts, and an FMU, each with its own steps.

The record is the simulation's own method of integration with the effect, so that nothing but the effect is missing.
"""
import pathlib
import zipfile

import numpy as np

import chain_effects
import ground_motions
import opensees_frames
import program_scripts
import program_sliders
from case_folder import write_case
from chain import Chain, between
from chain_effects import OUTPUT
from signals import colour
from slots import REST_S, effects_for
from systems import COARSE, FILES, STEP, draw_effect, draw_system, floor_of, truth_of_chain

DURATION = 15.0  # [s]
FMU_STEPS = 4  # per sample
KINDS = ("frame", "slider", "fmu")
COMPONENTS = "program"  # of the answer: ports


class SteppedChain(Chain):
    """The chain by the semi-implicit method of Euler, one step of the FMU after the other."""

    def _advance(self, x, loads, h, t):
        rate = self._rate(x, loads[1], t)
        speed = x["w"] + h * rate["w"]
        x = {"u": x["u"] + h * speed, "w": speed, "z": x["z"] + h * rate["z"], "f": x["f"] + h * rate["f"]}
        self._remember(between(x["u"]))
        return x


def _of_fmu(system, placed, ground):
    """Outputs of the FMU with effects: samples × outputs."""
    driven = system.driven(ground, placed, FMU_STEPS)[None, :]
    u, _ = SteppedChain([system.variant(placed)], len(system.k)).run(driven, STEP, FMU_STEPS, True)
    y = u[0][:, system.outputs].copy()
    for one in chain_effects.at_outputs(placed):
        y[:, one.at] = one.effect.act(y[:, one.at], one.values, STEP)
    return y


def _of_script(system, placed, ground):
    """Outputs of the script with effects, of which none is in a spring."""
    return opensees_frames.respond(system, placed, ground, 1)


def _library(is_fmu):
    """Effects where the simulation can take them: at its input and outputs, and at the ports of an FMU."""
    signals = [effect for effect in chain_effects.signal_effects()
               if effect.where == OUTPUT or effect.name not in ("saturation", "input_dead_zone", "absolute_value_sensor")]
    springs = [effect for effect in chain_effects.spring_effects() if effect.name != "transducer_backlash"]
    return signals + (springs if is_fmu else [])


def make(rng, number, slot, folder, sources):
    """Writes the case; returns its answer."""
    kind = KINDS[(number + number // 10) % len(KINDS)]  # each with all slots
    if kind == "slider":
        return program_sliders.make(rng, slot, folder, sources)
    is_fmu = kind == "fmu"
    respond = _of_fmu if is_fmu else _of_script
    system = draw_system(rng, slot.tier, True)
    files = ground_motions.files_of(sources)
    grounds = [opensees_frames.ground_of(rng, files, slot.duration(DURATION)) for _ in FILES]
    y, d, v = (x[0] for x in system.respond([grounds[0]], [system.variant()], [[]], COARSE))
    outsiders = [effect for effect in chain_effects.outsiders() if is_fmu or effect.where == OUTPUT]
    chosen = effects_for(slot.kind, rng, _library(is_fmu), outsiders)
    size = slot.size * (.7 if slot.kind == "pair" else 1)
    placed = [draw_effect(effect, system, (y, d, v), grounds[0], rng, size) for effect in chosen]
    recorded = [respond(system, placed, ground) for ground in grounds]
    noise = [colour(rng, slot.noise * float(column.std())) for column in y.T]
    noisy = [one + np.stack([n.draw(rng, len(one), STEP) for n in noise], axis=1) for one in recorded]
    stated = {f"k{i + 1}": k * (1 + rng.uniform(-.06, .06)) for i, k in enumerate(system.k)}
    stated |= {f"c{i + 1}": c * (1 + rng.uniform(-.2, .2)) for i, c in enumerate(system.c)}
    model = _fmu(folder, system, sources) if is_fmu else _script(folder, system)
    _write(folder, system, grounds, noisy, model, stated)
    entries, cells = truth_of_chain(system, placed, grounds[0], noise, rng, COMPONENTS)
    return {"effects": entries, "cells": cells, "specimen": {"kind": kind},
            "nrmse_on_unseen": {"oracle": floor_of(recorded[2], noisy[2])}}


def _write(folder, system, grounds, noisy, model, stated):
    names = [f"y{k + 1}" for k in range(len(system.outputs))]
    tables = {file: {"t": np.arange(len(ground)) * STEP, "a": ground} | dict(zip(names, y.T))
              for file, ground, y in zip(FILES, grounds, noisy)}
    document = {"name": f"{model['kind']}, {len(system.k)} masses",
                "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "quiet_s": [0, REST_S - .1]}
                           for k, file in enumerate(FILES)],
                "channels": {"time": "t [s]", "input": {"u": "a [m/s2]"}, "output": {name: f"{name} [m]" for name in names}},
                "model": model | {"fitted": list(stated),
                                  "parameters": {name: {"value": value} for name, value in stated.items()}}}
    write_case(folder, document, tables)


def _outputs(system):
    return {f"output.y{k + 1}": mass for k, mass in enumerate(system.outputs)}


def _script(folder, system):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "frame.py").write_text(program_scripts.frame(system.masses))
    parameters = [f"{{{letter}{i + 1}}}" for i in range(len(system.k)) for letter in "kc"]
    return {"kind": "opensees", "script": "frame.py", "arguments": ["{ground}", "{step_s}", *parameters],
            "inputs": {"input.u": "ground"},
            "outputs": {role: {"file": "floors.out", "column": mass + 1} for role, mass in _outputs(system).items()}}


def _fmu(folder, system, sources):
    folder.mkdir(parents=True, exist_ok=True)
    library = pathlib.Path(sources["generator"]).with_name("trial_fmu.so")
    with zipfile.ZipFile(folder / "chain.fmu", "w") as fmu:
        fmu.writestr(zipfile.ZipInfo("modelDescription.xml"), program_scripts.FMU_DESCRIPTION)
        fmu.writestr(zipfile.ZipInfo("binaries/linux64/trial_fmu.so"), library.read_bytes())
    return {"kind": "fmu", "file": "chain.fmu", "step_s": STEP / FMU_STEPS,
            "start": {f"m{i + 1}": mass for i, mass in enumerate(system.masses)},
            "inputs": {"input.u": "a"},
            "outputs": {role: f"y{mass + 1}" for role, mass in _outputs(system).items()},
            "port": {f"{i + 1}": {"displacement": f"d{i + 1}", "velocity": f"v{i + 1}", "force": f"f{i + 1}"}
                     for i in range(len(system.k))}}

# SPDX-License-Identifier: Apache-2.0
"""Effects added to recordings of laboratories, beside a model that fits the recording without them.

Tier "raw": the recording itself plus the effect; what the model cannot explain of it remains. Its control is the same
case without the effect: what the tool names there is of the recording. Other tiers: the model's force under the recorded motion, plus noise, plus the effect. The noise is the model's residual on the first record with
random phases. Only there is it known that nothing else is missing.
"""
import dataclasses
import pathlib
from collections.abc import Callable

import numpy as np

import effects
from case_folder import write_case
from force_truth import ForceTruth, force_cells, nrmse, thin, whitener_of
from motion import Motion, presliding
from opensees_bearings import effect_entry
from signals import low_passed, rate_of
from slots import SLOTS, effects_for

SMOOTH_HZ = 30.0  # of the recorded displacement, before it is differentiated
RAW = {0: "raw", 5: "raw", 8: "raw"}  # numbers of slots in which the recording itself is used
DRAWS = 24
RATE_HZ = 250.0  # recordings are thinned to about this rate
IDLE_S = 20.0  # at most, of a record without motion, with the same noise


@dataclasses.dataclass(frozen=True)
class Recording:
    """@param law  motion, parameters → force; @param start  parameters; `shapes` are not linear in the force"""
    files: tuple  # (file, first row, end row) to fit, held out, unseen
    columns: dict  # role → (column, factor to SI)
    start: dict
    law: Callable
    model: Callable  # parameters → tables of [model], fitted names
    has: frozenset  # effects that the model contains, and those that it cannot be told from
    settle_s: float = 0.1


def _emps(m, p):
    return (p["mass"] * m.a + p["viscous"] * m.v + p["friction"] * presliding(m.u, p["presliding"])
            + p["backwards"] * np.where(m.v < 0, m.v, 0.0))


def _emps_model(p):
    return ({"platen_inertia": {"axes": ["long"], "mass_kg": p["mass"]},
             "asymmetric_viscous": {"axes": ["long"], "forward_coefficient_N_s_per_m": p["viscous"],
                                    "backward_coefficient_N_s_per_m": p["viscous"] + p["backwards"]},
             "coulomb_friction": {"axes": ["long"], "friction_force_N": p["friction"], "presliding_m": p["presliding"]},
             "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}},
            ["platen_inertia.mass", "asymmetric_viscous.forward_coefficient", "asymmetric_viscous.backward_coefficient",
             "coulomb_friction.friction_force", "coulomb_friction.presliding", "force_offset.offset"])


def _damper(m, p):
    return p["viscous"] * m.v + p["friction"] * presliding(m.u, p["presliding"]) + p["spring"] * m.u


def _damper_model(p):
    return ({"viscous_friction": {"axes": ["long"], "coefficient_N_s_per_m": p["viscous"]},
             "coulomb_friction": {"axes": ["long"], "friction_force_N": p["friction"], "presliding_m": p["presliding"]},
             "polynomial_stiffness": {"axes": ["long"], "linear_N_per_m": p["spring"]},
             "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}},
            ["viscous_friction.coefficient", "coulomb_friction.friction_force", "coulomb_friction.presliding",
             "polynomial_stiffness.linear", "force_offset.offset"])


def _stop(m, p):
    """Asymmetric stop operator behind play, as the friction device needs."""
    low, high, half = -p["backward_length"], p["forward_length"], p["play"] / 2
    y = np.zeros_like(m.u)
    for k in range(1, len(y)):
        y[k] = np.clip(y[k - 1] + m.u[k] - m.u[k - 1], low - half, high + half)
    forwards = p["forward"] / p["forward_length"] * np.maximum(0, y - half)
    return forwards + p["backward"] / p["backward_length"] * np.minimum(0, y + half) + p["viscous"] * m.v


def _stop_model(p):
    return ({"asymmetric_hysteresis": {"axes": ["long"], "forward_force_N": p["forward"], "backward_force_N": p["backward"],
                                       "forward_length_m": p["forward_length"], "backward_length_m": p["backward_length"],
                                       "play_m": p["play"]},
             "viscous_friction": {"axes": ["long"], "coefficient_N_s_per_m": p["viscous"]},
             "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}},
            [f"asymmetric_hysteresis.{name}" for name in ("forward_force", "backward_force", "forward_length",
                                                          "backward_length", "play")]
            + ["viscous_friction.coefficient", "force_offset.offset"])


DRY = frozenset(("coulomb_friction", "asymmetric_friction", "viscous_friction", "asymmetric_viscous", "force_gain"))
RECORDINGS = {
    "emps": Recording(
        (("emps/emps_est.csv", 0, 24800), ("emps/emps_val_pulses.csv", 0, 12400), ("emps/emps_val_pulses.csv", 12400, 24800)),
        {"u": ("qm_m", 1.0), "F": ("vir_V", 35.15065)},
        {"mass": 95.0, "viscous": 200.0, "backwards": 70.0, "friction": 20.0, "presliding": 1e-4}, _emps, _emps_model,
        DRY | {"platen_inertia"}),
    "damper": Recording(
        tuple((f"mr_damper_usm/sinusoidal/25mm{f}0x5A.csv", 0, None) for f in ("0x1Hz", "0x25Hz", "0x5Hz")),
        {"u": ("x_mm", 1e-3), "F": ("F_N", 1.0)},
        {"viscous": 1000.0, "friction": 500.0, "spring": 1000.0, "presliding": 1e-3}, _damper, _damper_model, DRY),
    "device": Recording(
        tuple((f"brfd_lehigh/{f}Hz_36lb_amp1in.csv", 0, None) for f in ("0.25", "0.5", "1")),
        {"u": ("x_m", 1.0), "F": ("F_N", 1.0)},
        {"forward": 12e3, "backward": 18e3, "forward_length": 4e-3, "backward_length": 4e-3, "play": 5e-3, "viscous": 1e4},
        _stop, _stop_model, DRY | {"coulomb_friction"}),
}


def read(file, columns, first, end):
    with open(file) as lines:
        names = lines.readline().strip().split(",")
    table = np.genfromtxt(file, delimiter=",", skip_header=1, usecols=[0, *(names.index(c) for c, _ in columns.values())])
    table = table[first:end]
    step = float(np.median(np.diff(table[:, 0])))
    every = max(1, round(1 / (RATE_HZ * step)))
    if every > 1:
        table[:, 1:] = low_passed(table[:, 1:], 0.4 / (every * step), step)
    table = table[::every]
    return every * step, {role: factor * table[:, k] for k, (role, (_, factor)) in enumerate(columns.items(), 1)}


def motion_of(step, signals):
    u = signals["u"][:, None]
    smooth = low_passed(u, SMOOTH_HZ, step) if SMOOTH_HZ < 0.4 / step else u
    v = rate_of(smooth, step)
    return Motion(step, smooth, v, rate_of(v, step), None, signals["F"][:, None])


def fitted(recording, motions):
    """Least squares over the first two records, without offsets: Gauss-Newton with relative steps."""
    names, p = list(recording.start), dict(recording.start)

    def residual(values):
        rows = [thin(m.force - recording.law(m, values), m.step)[0] for m in motions[:2]]
        return np.concatenate([(row - row.mean(axis=0)).ravel() for row in rows])
    best = residual(p)
    for _ in range(12):
        slopes = np.stack([(residual(p | {n: p[n] * 1.01}) - best) / 0.01 for n in names], axis=1)
        step = np.clip(-np.linalg.lstsq(slopes, best, rcond=1e-9)[0], -.4, .4)
        for share in (1, .3, .1):
            tried = {n: p[n] * (1 + share * s) for n, s in zip(names, step)}
            found = residual(tried)
            if found @ found < best @ best:
                p, best = tried, found
                break
        else:
            break
    return p


def surrogate(rng, signal, samples=None):
    """The same amplitude spectrum and deviation with random phases, along axis 0; `samples` long, or as long."""
    spectrum, samples = np.abs(np.fft.rfft(signal, axis=0)), samples or len(signal)
    known, wanted = np.linspace(0, 1, len(spectrum)), np.linspace(0, 1, samples // 2 + 1)
    sizes = np.stack([np.interp(wanted, known, column) for column in spectrum.T], axis=1)
    turned = sizes * np.exp(2j * np.pi * rng.random(sizes.shape))
    turned[0] = 0
    drawn = np.fft.irfft(turned, samples, axis=0)
    return drawn * (signal - signal.mean(axis=0)).std(axis=0) / drawn.std(axis=0)


def make(rng, number, folder, sources):
    """Writes the case; returns its answer."""
    name = list(RECORDINGS)[number % len(RECORDINGS)]
    recording, slot = RECORDINGS[name], SLOTS[number % len(SLOTS)]
    data = pathlib.Path(sources["data"])
    if not (data / recording.files[0][0]).is_file():
        raise RuntimeError(f"{data / recording.files[0][0]}: missing")
    read_in = [read(data / file, recording.columns, first, end) for file, first, end in recording.files]
    motions = [motion_of(*one) for one in read_in]
    p = fitted(recording, motions)
    is_raw = number % len(SLOTS) in RAW and slot.kind != "none"
    bases = [recording.law(m, p) for m in motions]
    residuals = [m.force - base - (m.force - base).mean(axis=0) for m, base in zip(motions, bases)]
    level = (.3 if slot.tier == "small" else 1) * float(residuals[0].std() / bases[0].std()) / 0.02
    library = [e for e in effects.usable(motions[0]) if e.in_library and e.name not in recording.has]
    chosen = effects_for(slot.kind, rng, library, [e for e in effects.usable(motions[0]) if not e.in_library])
    model = [dataclasses.replace(m, force=base) for m, base in zip(motions, bases)]
    scales = model[0].peaks()
    size = min(max(level, slot.size), 8.0)  # seen beside the residual of the model
    hidden = {e.name: effects.draw(e, model[0], rng, size) for e in chosen}
    # One sensor's noise on all records: that of the first one's residual.
    noise = [m.force - base if is_raw else surrogate(rng, residuals[0], len(base)) for m, base in zip(motions, bases)]
    clean = [_with(chosen, hidden, dataclasses.replace(m, scales=scales), base) for m, base in zip(model, bases)]
    recorded = [one + n for one, n in zip(clean, noise)]
    idle = None if is_raw else surrogate(rng, residuals[0])[:round(IDLE_S / motions[0].step)]
    # The recording's own motion, or the smooth one that the model's force belongs to.
    displacements = [one[1]["u"] if is_raw else m.u[:, 0] for one, m in zip(read_in, motions)]
    stated = {n: value * (1 + rng.uniform(-.05, .05)) for n, value in p.items()}
    _write(folder, name, recording, stated, displacements, recorded, motions, idle)
    if is_raw:
        _write(control_of(folder), name, recording, stated, displacements, [m.force for m in motions], motions, idle)
    whitener = whitener_of([surrogate(rng, residuals[0]) for _ in range(DRAWS)], motions[0].step)
    nuisances = [recording.law(motions[0], p | {n: p[n] * 1.01}) - bases[0] for n in p]
    entries = []
    for effect in chosen:
        without = _with([e for e in chosen if e is not effect], hidden, model[0], bases[0])
        truth = ForceTruth(dataclasses.replace(model[0], force=without), whitener, nuisances, None)
        entries.append(effect_entry(effect, hidden[effect.name],
                                    truth.of(effect.name, clean[0] - without, effect.special_case_of, effect.also)))
    return {"tier": "raw" if is_raw else slot.tier, "kind": slot.kind, "effects": entries, "cells": force_cells(model[0]),
            "control": control_of(folder).name if is_raw else None, "specimen": {"kind": name}, "nrmse_on_unseen": {"oracle": nrmse(recorded[2], clean[2], motions[2].step)}}


def control_of(folder):
    """Folder of the same case without its effects."""
    return folder.with_name(folder.name.removesuffix(".part") + "-control")


def _with(chosen, hidden, motion, force):
    """The force with the effects; those of sensors last."""
    for effect in sorted(chosen, key=lambda e: e.part == "sensor"):
        force = force + effect.act(motion, hidden[effect.name], force)
    return force


def _write(folder, name, recording, stated, displacements, forces, motions, idle):
    tables, files = {}, ("fit.csv", "second.csv", "unseen.csv")
    for file, u, force, motion in zip(files, displacements, forces, motions):
        tables[file] = {"t": motion.t, "u": u, "F": force[:, 0]}
    terms, free = recording.model(stated)
    peaks = motions[0].peaks()
    document = {"name": name,
                "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "settle_s": recording.settle_s}
                           for k, file in enumerate(files)],
                "channels": {"time": "t [s]", "displacement": {"long": "u [m]"}, "force": {"long": "F [N]"}},
                "model": {"kind": "platen", "fitted": free} | terms,
                "map": {"displacement_m": 1.05 * peaks["U"], "velocity_m_per_s": 1.05 * peaks["V"]}}
    if idle is not None:
        tables["idle.csv"] = {"t": motions[0].step * np.arange(len(idle)), "u": np.zeros(len(idle)), "F": idle[:, 0]}
        document["record"].append({"file": "idle.csv", "use": "reference", "quiet_s": [0.1, motions[0].step * len(idle) - 0.1]})
    write_case(folder, document, tables)

# SPDX-License-Identifier: Apache-2.0
"""The closed-loop laboratory in virtual time, with effects hidden in its bearing, machine or load cell."""
import dataclasses
import math
import pathlib
import subprocess
import tempfile

import numpy as np

import effects
import lead
from case_folder import toml_of, write_case
from effects import Effect, Size
from force_truth import ForceTruth, force_cells, nrmse, whitener_of
from motion import Motion, bouc_wen, presliding
from opensees_bearings import AXES, effect_entry, perturbed
from signals import fused, low_passed, rate_of
from slots import SLOTS, effects_for

STEP = 0.004  # of the truth [s]; the laboratory records every millisecond
EVERY = 4
TABLE_STEP = 0.001  # of recording and case [s]
REST_S = 2.0
DRAWS = 6
CROSSOVER_HZ = 5.0  # where the noise of both sensors of motion is the same
BARE_HZ = 20.0  # where the motion ends, and with it its noise, if there are no accelerometers
BEARING = {"characteristic_strength": 1_010_000.0, "post_yield_stiffness": 4_238_095.0, "yield_displacement": 2.855e-3}
PLUG = BEARING["characteristic_strength"], BEARING["yield_displacement"]
MACHINE = {"mass": np.array([113_371.0, 116_836.0]), "friction": np.array([5100.0, 8600.0]), "viscous": np.array([716.0, 870.0])}
NOISE = {"u": 5e-5, "F": 5e3}  # standard deviations of the laboratory's sensors
UNITS = {"friction_force": "_N", "friction_coefficient": "", "coefficient": {"quadratic_drag": "_N_s2_per_m2"},
         "breakaway_force": "_N", "stribeck_velocity": "_m_per_s", "presliding": "_m", "place": "_m", "width": "_m",
         "stiffness": {"cubic_stiffness": "_N_per_m3", "asymmetric_stiffness": "_N_per_m2", "large_strain_stiffening": "_N_per_m",
                       "viscoelastic_relaxation": "_N_per_m"},
         "onset": "_m", "relaxation_time": "_s", "factor": "", "rate": "_N_per_s", "limit": "_N", "skew": "_s",
         "time_constant": "_s", "force": "_N", "pitch": "_m", "phase": "_rad"}
MOTIONS = ("petrolia_1992_riodell_freefield", "imperial_valley_1979_meloland_freefield")
SCALES = {"petrolia_1992_riodell_freefield": (1.0, 1.4), "imperial_valley_1979_meloland_freefield": (0.8, 1.0)}


def _heated(motion, values, force):
    """Change by the heated lead plug, along the motion."""
    return lead.heated(motion, *PLUG)[0] - PLUG[0] * bouc_wen(motion.u, PLUG[1])


HEATING = Effect("lead_heating", "bearing", (Size("softening", "1", lead.SOFTENING, lead.SOFTENING),), _heated, also=("adiabatic_heating",))
HIDDEN = ("load_dependent_friction", "quadratic_drag", "stribeck_friction", "position_dependent_friction", "cubic_stiffness",
          "asymmetric_stiffness", "large_strain_stiffening", "viscoelastic_relaxation", "force_gain", "force_drift",
          "force_saturation", "force_skew", "force_filter_lag")


def _smooth(motion):
    """Force of bearing and machine without effects and without dry friction, along a motion."""
    return (BEARING["post_yield_stiffness"] * motion.u
            + BEARING["characteristic_strength"] * bouc_wen(motion.u, BEARING["yield_displacement"])
            + MACHINE["mass"] * motion.a + MACHINE["viscous"] * motion.v)


def _base(motion):
    return _smooth(motion) + MACHINE["friction"] * presliding(motion.u, 1e-5)


def _library(is_bare):
    by_name = {effect.name: effect for effect in effects.all_effects()}
    hidden = [by_name[name] for name in HIDDEN] + 3 * [HEATING]
    return [effect for effect in hidden if not is_bare or effect.needs != "load"], [by_name["cogging"]]


def _term(effect, values):
    """Path of the term's table in an experiment, and the table."""
    kind = effect.name.removeprefix("force_") if effect.part == "sensor" else effect.name
    kind = {"skew": "time_skew"}.get(kind, kind)
    table = {"kind": kind, "channel": "force"} if effect.part == "sensor" else {}
    if "phase" in values:
        values = values | {"phase": math.remainder(values["phase"], 2 * math.pi)}
    for name, value in values.items():
        unit = UNITS[name]
        table[name + (unit if isinstance(unit, str) else unit[kind])] = value
    return ("specimen" if effect.part == "bearing" else "machine"), effect.name, table


def _experiment(chosen, hidden, seed, motions, columns):
    document = {
        "format": 1, "name": "trial", "map": "srmd", "axes": list(AXES), "integration_step_s": 0.01, "duration_s": 30.0,
        "rest_s": REST_S, "seed": seed,
        "motion": motions[0] | columns, "held_out": motions[1] | columns,
        "specimen": {"model": "lprb", "lead_heating": {"enabled": any(e is HEATING for e in chosen)}}, "machine": {},
        "node": {"srmd": {"adapter": "srmd"}, "xpc": {"adapter": "simulink_like", "diagram": "hybrid_controller"},
                 "opf": {"adapter": "numerical"}, "recorder": {"adapter": "recorder"}}}
    for effect in (e for e in chosen if e is not HEATING):
        place, name, table = _term(effect, hidden[effect.name])
        document[place][name] = table
    return toml_of(document)


def _recorded(rths, file, folder):
    """Signals of a run, as recorded."""
    names = [f"srmd.{axis}.{word}.fbk" for word in ("displ", "accel", "force") for axis in AXES] + ["srmd.vert.force.fbk"]
    table = folder / (file + ".csv")
    subprocess.run([rths, "export", str(folder / file), "--signals", *names, "--out", str(table)], check=True, capture_output=True)
    values = np.genfromtxt(table, delimiter=",", skip_header=1)
    values = values[:-1000]  # without the end of the run
    return {"u": values[:, 1:3], "a": values[:, 3:5], "F": values[:, 5:7], "N": values[:, 7]}


def _run(sources, chosen, hidden, seed, motions, columns):
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        (folder / "trial.toml").write_text(_experiment(chosen, hidden, seed, motions, columns))
        ran = subprocess.run([str(sources["rths"]), "run", "trial.toml", "--clock", "virtual", "--no-diagnosis", "--out", "run"],
                             cwd=folder, capture_output=True, text=True, check=False)
        if ran.returncode > 1:
            raise RuntimeError(f"the laboratory failed: {(ran.stderr or ran.stdout).strip().splitlines()[-1]}")
        return [_recorded(sources["rths"], file, folder / "run") for file in ("run.h5", "held_out.h5")]


def motion_of(record):
    """Fused motion and force, filtered and thinned to STEP."""
    record = {quantity: low_passed(values, 0.4 / STEP, TABLE_STEP)[::EVERY] for quantity, values in record.items()}
    u = fused(record["u"], record["a"], STEP, CROSSOVER_HZ)
    v = rate_of(u, STEP)
    return Motion(STEP, u, v, rate_of(v, STEP), record["N"], record["F"])


def make(rng, number, folder, sources):
    """Writes the case; returns its answer."""
    slot = SLOTS[number % len(SLOTS)]
    order = rng.permutation(2)
    motions = [{"file": str(sources["records"] / f"{MOTIONS[k]}.csv"), "column_vert": 3, "scale": float(rng.uniform(*SCALES[MOTIONS[k]]))}
               for k in order]
    columns = dict(zip(("column_long", "column_lat"), (1, 2) if rng.random() < .5 else (2, 1)))
    is_bare = slot.tier == "missing"
    library, outsiders = _library(is_bare)
    chosen = effects_for(slot.kind, rng, library, outsiders)
    size = Motion(STEP, np.full((2, 2), .2), np.full((2, 2), .6), np.full((2, 2), 3.0), np.full(2, 9.7e6), np.full((2, 2), 1.9e6))
    peaks = size.peaks() | {"T": 30.0}
    typical = dataclasses.replace(size, scales=peaks)
    hidden = {e.name: effects.draw(e, typical, rng, slot.size * (.7 if slot.kind == "pair" else 1)) for e in chosen}
    records = _run(sources, chosen, hidden, int(rng.integers(1, 2**31)), motions, columns)
    if "lead_heating" in hidden:
        hidden["lead_heating"] = {"softening": lead.effective_softening(motion_of(records[0]), *PLUG)}
    entries, base = _truth(motion_of(records[0]), chosen, hidden, rng, is_bare)
    _write(folder, records, base, is_bare, perturbed(BEARING, rng))
    unseen = motion_of(records[1])
    force = _base(unseen)
    noisy = force + _noise(unseen, rng, is_bare)  # the equations above are not exact enough for a floor
    return {"tier": slot.tier if slot.tier not in ("noisy", "short") else "standard", "kind": slot.kind, "effects": entries,
            "cells": force_cells(base), "specimen": {"kind": "lprb"},
            "nrmse_on_unseen": {"oracle": nrmse(noisy, force, STEP)}}


def _with(chosen, hidden, motion, force):
    base = force
    for effect in sorted(chosen, key=lambda e: e.part == "sensor"):
        force = force + effect.act(motion, hidden[effect.name], base if effect is HEATING else force)
    return force


def _noise(motion, rng, is_bare):
    """A draw of the load cell's noise, at the case's rate, and of the force that the noise of the motion causes.

    Accelerometers leave the noise of the displacement below the crossover alone; without them it moves velocity and
    acceleration too. Dry friction is left out: near rest its sign would follow the noise.
    """
    heard = rng.standard_normal((EVERY * len(motion.u), 2)) * NOISE["F"]
    moved = rng.standard_normal((EVERY * len(motion.u), 2)) * NOISE["u"]
    moved = low_passed(moved, BARE_HZ if is_bare else CROSSOVER_HZ, TABLE_STEP)[::EVERY]
    noisy = dataclasses.replace(motion, u=motion.u + moved)
    if is_bare:
        noisy = dataclasses.replace(noisy, v=motion.v + rate_of(moved, STEP), a=motion.a + rate_of(rate_of(moved, STEP), STEP))
    return _smooth(noisy) - _smooth(motion) + low_passed(heard, 0.4 / STEP, TABLE_STEP)[::EVERY]


def _truth(motion, chosen, hidden, rng, is_bare):
    """Entries of the effects, and the motion with the force without them."""
    force = _base(motion)
    base = dataclasses.replace(motion, force=force)
    if not chosen:
        return [], base
    draws = [_noise(motion, rng, is_bare) for _ in range(DRAWS)]
    q, uy = BEARING["characteristic_strength"], BEARING["yield_displacement"]
    z = bouc_wen(motion.u, uy)
    nuisances = [q * z, motion.u, q * (bouc_wen(motion.u, uy * 1.02) - z)]
    whitener = whitener_of(draws, STEP)
    entries = []
    whole = _with(chosen, hidden, base, force)
    for effect in chosen:
        without = _with([e for e in chosen if e is not effect], hidden, base, force)
        truth = ForceTruth(dataclasses.replace(base, force=without), whitener, nuisances, q * z)
        entries.append(effect_entry(effect, hidden[effect.name],
                                    truth.of(effect.name, whole - without, effect.special_case_of, effect.also)))
    return entries, base


def _write(folder, records, base, is_bare, stated):
    tables = {}
    for file, record in zip(("fit.csv", "unseen.csv"), records):
        columns = {"t": TABLE_STEP * np.arange(len(record["N"]))}
        for quantity in ("u", "a", "F"):
            columns |= {f"{quantity}_{letter}": record[quantity][:, k] for k, letter in enumerate("xy")}
        tables[file] = columns | {"N": record["N"]}
    channels = {"time": "t [s]", "displacement": dict(zip(AXES, ("u_x [m]", "u_y [m]"))),
                "force": dict(zip(AXES, ("F_x [N]", "F_y [N]")))}
    if not is_bare:
        channels |= {"acceleration": dict(zip(AXES, ("a_x [m/s2]", "a_y [m/s2]"))), "vertical_force": "N [N]"}
    peaks = base.peaks()
    terms = {"bouc_wen": {"characteristic_strength_N": stated["characteristic_strength"],
                          "post_yield_stiffness_N_per_m": stated["post_yield_stiffness"],
                          "yield_displacement_m": stated["yield_displacement"]},
             "platen_inertia": {"mass_kg": MACHINE["mass"]},
             "coulomb_friction": {"friction_force_N": MACHINE["friction"], "presliding_m": 1e-5},
             "viscous_friction": {"coefficient_N_s_per_m": MACHINE["viscous"]},
             "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}}
    document = {"name": "closed loop",
                "record": [{"file": file, "use": use, "quiet_s": [0.1, REST_S - .3]}
                           for file, use in (("fit.csv", "fit"), ("unseen.csv", "held_out"))],
                "channels": channels,
                "model": {"kind": "platen", "fitted": [f"bouc_wen.{name}" for name in BEARING] + ["force_offset.offset"]} | terms,
                "map": {"displacement_m": 1.05 * peaks["U"], "velocity_m_per_s": 1.05 * peaks["V"]}}
    write_case(folder, document, tables)

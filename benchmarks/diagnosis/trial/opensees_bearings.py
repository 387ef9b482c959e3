# SPDX-License-Identifier: Apache-2.0
"""Bearings, sliders and pendulums of OpenSees along prescribed motions; the effect is off in the simulation.

The record's effect is one of OpenSees (heating of the lead, friction that depends on velocity or pressure, or a
uniaxial material beside the bearing), or of the trial's own equations (effects.py).
"""
import dataclasses

import numpy as np

import effects
import ground_motions
import lead
from case_folder import write_case
from effects import Effect, Size, shape
from force_truth import ForceTruth, force_cells, nrmse, whitener_of
from motion import Motion
from opensees_runs import FINE, bearing_force
from signals import colour, fused, low_passed, random_sines, rate_of
from slots import REST_S, effects_for

STEP = 0.005  # [s]
DURATION = 22.0  # [s]
LOAD = 9.7e6  # mean vertical force [N]
DRAWS = 8
# Steps of the analysis per recorded sample: 0.25 ms. OpenSees returns to the sliding surface at the end of a step, so a
# longer step makes the force of a slider late and its loops softer.
RECORDED = 20
FILES = ("fit.csv", "second.csv", "unseen.csv")
AXES = ("long", "lat")
SLIDER = ("-P", 1, "-T", 2, "-My", 2, "-Mz", 2, "-orient", 0, 0, 1, 1, 0, 0)

# Effects of OpenSees itself. Their values are arguments of the element or of a material.
HEATING = Effect("lead_heating", "bearing", (Size("softening", "1", .0069, .0069),), None,
                 also=("adiabatic_heating",))
VELOCITY = Effect("velocity_dep_sliding", "bearing",
                  (Size("low_velocity_reduction", "1", .25, .6), shape("rate", "1", 15, 60)), None)
PRESSURE = Effect("pressure_dep_sliding", "bearing", (Size("reduction", "1", .3, .6),), None, needs="load",
                  also=("pressure_tanh_sliding",))
OF_OPENSEES = {"lead": [HEATING], "bouc_wen": [], "flat": [VELOCITY, PRESSURE], "pendulum": [VELOCITY, PRESSURE]}
IN_PARALLEL = {"viscous_friction", "quadratic_drag", "viscoelastic_relaxation"}


@dataclasses.dataclass
class Specimen:
    kind: str
    values: dict  # true parameters of its model

    def element(self, values, hidden):
        """Description for OpenSees, with given parameters and the effects of OpenSees in `hidden`."""
        if self.kind == "bouc_wen":
            post, yields = values["post_yield_stiffness"], values["yield_displacement"]
            first = post + values["characteristic_strength"] / yields
            return {"element": ["elastomericBearingBoucWen", first, values["characteristic_strength"], post / first,
                                0.0, 2.0, 2.0, 0.5, 0.5, *SLIDER]}
        if self.kind == "lead":
            return {"element": self._lead_rubber(values, 1 if "lead_heating" in hidden else 0)}
        model = self._friction(values["friction_coefficient"], hidden)
        name = ["flatSliderBearing", 1] if self.kind == "flat" else ["singleFPBearing", 1, values["effective_radius"]]
        return {"friction": [model], "element": [*name, values["initial_stiffness"], *SLIDER, "-iter", 200, 1e-6]}

    @staticmethod
    def _lead_rubber(values, heats):
        post, strength = values["post_yield_stiffness"], values["characteristic_strength"]
        area = 0.25 * np.pi * (1.35**2 - 0.3586**2)
        shear = post * 25 * 0.01 / area
        share = post / (post + strength / values["yield_displacement"])
        return ["LeadRubberX", strength, share, shear, 2e9, 0.3586, 1.35, 0.005, 0.01, 25, 0, 0, 1, 1, 0, 0,
                10, 0.5, 1, 0.5, 0, 0, 0, 11200, 130, 50, 1.41e-5, 0, 0, 0, 0, heats]

    @staticmethod
    def _friction(friction, hidden):
        if "velocity_dep_sliding" in hidden:
            own = hidden["velocity_dep_sliding"]
            return ["VelDependent", 1, friction * (1 - own["low_velocity_reduction"]), friction, own["rate"]]
        if "pressure_dep_sliding" in hidden:  # muFast = muFast0 − deltaMu tanh(alpha p)
            area, reduction = 0.3, hidden["pressure_dep_sliding"]["reduction"]
            scale = area / LOAD
            above = friction / (1 - reduction * np.tanh(1.0))
            return ["VelPressureDep", 1, above * (1 - 1e-6), above, area, reduction * above, scale, 1e4]
        return ["Coulomb", 1, friction]

    def toml(self, stated):
        term = {"lead": "bouc_wen_nagarajaiah", "bouc_wen": "bouc_wen", "flat": "flat_slider", "pendulum": "single_pendulum"}[self.kind]
        units = {"characteristic_strength": "_N", "post_yield_stiffness": "_N_per_m", "yield_displacement": "_m",
                 "friction_coefficient": "", "initial_stiffness": "_N_per_m", "effective_radius": "_m"}
        table = {name + units[name]: value for name, value in stated.items()}
        if self.kind == "pendulum":  # OpenSees counts the slope of the sphere into the initial stiffness
            table["initial_stiffness_N_per_m"] -= LOAD / self.values["effective_radius"]
        free = [name for name in stated if name != "initial_stiffness"]
        return term, table, [f"{term}.{name}" for name in free]


def draw_specimen(kind, rng):
    if kind in ("bouc_wen", "lead"):
        values = {"characteristic_strength": 1.0e6 * rng.uniform(.8, 1.2),
                  "post_yield_stiffness": 4.2e6 * rng.uniform(.8, 1.2), "yield_displacement": rng.uniform(.01, .02)}
    else:
        values = {"friction_coefficient": rng.uniform(.05, .11), "initial_stiffness": LOAD * rng.uniform(20, 60)}
        if kind == "pendulum":
            values["effective_radius"] = rng.uniform(1.8, 3)
    return Specimen(kind, values)


def perturbed(values, rng):
    """What the simulation states: up to 7 % beside the truth, the displacement of yield 15 %."""
    return {name: value if name == "initial_stiffness" else
            value * (1 + rng.uniform(-1, 1) * (.15 if name == "yield_displacement" else .07))
            for name, value in values.items()}


class Test:
    """One record: motion, load, and forces with and without the effects."""

    def __init__(self, rng, files, duration, specimen):
        self.specimen = specimen
        self.u = low_passed(ground_motions.platen_motion(rng, files, duration, REST_S, rng.uniform(.12, .2), STEP),
                            12.0, STEP)
        self.v, self.t = rate_of(self.u, STEP), np.arange(len(self.u)) * STEP
        shakes = random_sines(rng, self.t, 1, 8, 0.12) * np.clip(self.t - REST_S, 0, 1)
        self.load = LOAD * (1 + np.clip(shakes, -.5, .5))

    def motion(self, force, scales=None):
        return Motion(STEP, self.u, self.v, rate_of(self.v, STEP), self.load, force, scales)

    def normal_force(self, hidden):
        """The force that presses the slider; on the sphere of a pendulum it contains a part of the horizontal force.

        OpenSees has it in the law, the simulation of small slopes as the vertical force.
        """
        if self.specimen.kind != "pendulum":
            return self.load
        inside = {name: own for name, own in hidden.items() if name not in IN_PARALLEL}
        force = self.bearing(self.specimen.values, inside)
        return self.load + (force * self.u).sum(axis=1) / self.specimen.values["effective_radius"]

    def bearing(self, values, hidden, u=None, divisions=FINE):
        """Force of OpenSees [N]; `hidden`: effect name → values."""
        u = self.u if u is None else u
        beside = [(axis, material) for name, own in hidden.items() for axis in range(2)
                  for material in _material(name, own, axis)]
        v = self.v if u is self.u else rate_of(u, STEP)
        return bearing_force(self.specimen.element(values, hidden), u, v, self.load, STEP, beside, divisions)


def _material(name, own, axis):
    if name == "viscous_friction":
        return [("Viscous", float(own["coefficient"][axis]), 1.0)]
    if name == "quadratic_drag":
        return [("Viscous", float(own["coefficient"]), 2.0)]
    if name == "viscoelastic_relaxation":
        stiffness, time = float(own["stiffness"]), float(own["relaxation_time"])
        return [("Maxwell", stiffness, stiffness * time, 1.0, 1.0)]
    return []


def whole_force(test, values, hidden, chosen, scales=None, u=None, without=None, divisions=FINE):
    """Force at the load cell, with all effects but `without`."""
    mine = {name: own for name, own in hidden.items() if name != without}
    of_opensees = {name: own for name, own in mine.items()
                   if name in IN_PARALLEL or name in ("lead_heating", "velocity_dep_sliding", "pressure_dep_sliding")}
    force = test.bearing(values, of_opensees, u, divisions)
    motion = test.motion(force, scales)
    if u is not None:
        motion = dataclasses.replace(motion, u=u, v=rate_of(u, STEP), a=rate_of(rate_of(u, STEP), STEP))
    rest = [effect for effect in chosen if effect.name in mine and effect.name not in of_opensees]
    for effect in (e for e in rest if e.part != "sensor"):
        force = force + effect.act(motion, mine[effect.name], force)
    for effect in (e for e in rest if e.part == "sensor"):
        force = force + effect.act(motion, mine[effect.name], force)
    return force


def _has_load(kind, is_bare):
    """Whether the vertical force is recorded."""
    return not is_bare or kind in ("flat", "pendulum")


def _library(kind, is_bare):
    own = [e for e in effects.all_effects() if e.in_library and e.name not in ("force_clock_drift",)]
    return [e for e in own + 3 * OF_OPENSEES[kind] if e.needs != "load" or _has_load(kind, is_bare)]


def make(rng, slot, folder, sources, kind):
    """Writes the case; returns its answer."""
    specimen, stated = draw_specimen(kind, rng), None
    stated = perturbed(specimen.values, rng)
    tests = [Test(rng, ground_motions.files_of(sources), slot.duration(DURATION), specimen) for _ in FILES]
    is_bare = slot.tier == "missing"
    chosen = effects_for(slot.kind, rng, _library(kind, is_bare), [e for e in effects.all_effects() if not e.in_library])
    base = tests[0].motion(tests[0].bearing(specimen.values, {}))
    hidden = {effect.name: effects.draw(effect, base, rng, slot.size * (.7 if slot.kind == "pair" else 1))
              for effect in chosen}
    if "lead_heating" in hidden:  # as the catalogue's law with one cooling time has it
        hidden["lead_heating"] = {"softening": lead.effective_softening(
            base, specimen.values["characteristic_strength"], specimen.values["yield_displacement"])}
    scales = base.peaks()
    noise = {"u": colour(rng, slot.noise * float(base.u.std())), "a": colour(rng, slot.noise * float(base.a.std())),
             "F": colour(rng, slot.noise * float(base.force.std())), "N": colour(rng, 1e-3 * LOAD)}
    forces = [whole_force(test, specimen.values, hidden, chosen, scales, divisions=RECORDED) for test in tests]
    recorded = [_record(test, force, test.normal_force(hidden), noise, rng) for test, force in zip(tests, forces)]
    _write(folder, specimen, stated, recorded, base, is_bare, kind)
    truth = _truth(tests[0], specimen, hidden, chosen, base, noise, is_bare, rng)
    return {"effects": truth[0], "cells": truth[1], "specimen": {"kind": kind},
            "nrmse_on_unseen": _floors(tests[2], specimen, hidden, chosen, scales, recorded[2])}


def _record(test, force, load, noise, rng):
    samples = len(test.t)
    columns = {"t [s]": test.t}
    for axis, letter in enumerate("xy"):
        columns[f"u_{letter} [m]"] = test.u[:, axis] + noise["u"].draw(rng, samples, STEP)
    acceleration = rate_of(test.v, STEP)
    for axis, letter in enumerate("xy"):
        columns[f"a_{letter} [m/s2]"] = acceleration[:, axis] + noise["a"].draw(rng, samples, STEP)
    for axis, letter in enumerate("xy"):
        columns[f"F_{letter} [kN]"] = (force[:, axis] + noise["F"].draw(rng, samples, STEP)) / 1e3
    columns["N [kN]"] = (load + noise["N"].draw(rng, samples, STEP)) / 1e3
    return columns


def _write(folder, specimen, stated, recorded, base, is_bare, kind):
    term, table, free = specimen.toml(stated)
    channels = {"time": "t [s]", "displacement": dict(zip(AXES, ("u_x [m]", "u_y [m]"))),
                "force": dict(zip(AXES, ("F_x [kN]", "F_y [kN]")))}
    if not is_bare:
        channels["acceleration"] = dict(zip(AXES, ("a_x [m/s2]", "a_y [m/s2]")))
    if _has_load(kind, is_bare):
        channels["vertical_force"] = "N [kN]"
    peaks = base.peaks()
    document = {
        "name": f"{kind} bearing",
        "record": [{"file": file, "use": "fit" if k == 0 else "held_out", "quiet_s": [0, REST_S - .1]}
                   for k, file in enumerate(FILES)],
        "channels": channels,
        "model": {"kind": "platen", "fitted": [*free, "force_offset.offset"], term: table,
                  "force_offset": {"kind": "offset", "channel": "force", "offset_N": 0}},
        "map": {"displacement_m": 1.05 * peaks["U"], "velocity_m_per_s": 1.05 * peaks["V"]}}
    write_case(folder, document, dict(zip(FILES, recorded)))


def _truth(test, specimen, hidden, chosen, base, noise, is_bare, rng):
    """Entries of the effects, and cells."""
    def draw(quantity):
        return np.stack([noise[quantity].draw(rng, len(test.t), STEP) for _ in AXES], axis=1)
    draws = []
    for _ in range(DRAWS):
        # An observer smooths the recorded motion or, better, fuses it with the recorded acceleration.
        moved = low_passed(draw("u"), 12.0, STEP) if is_bare else fused(draw("u"), draw("a"), STEP)
        heard = draw("F")
        draws.append(test.bearing(specimen.values, {}, test.u + moved) - base.force + heard)
    free = [name for name in specimen.values if name != "initial_stiffness"]
    nuisances = [test.bearing(specimen.values | {name: specimen.values[name] * 1.01}, {}) - base.force for name in free]
    linear = specimen.values.get("post_yield_stiffness", 0)
    whitener = whitener_of(draws, STEP)
    entries = []
    whole = whole_force(test, specimen.values, hidden, chosen)
    for effect in chosen:
        without = whole_force(test, specimen.values, hidden, chosen, without=effect.name)
        beside = dataclasses.replace(base, force=without)
        truth = ForceTruth(beside, whitener, nuisances, base.force - linear * base.u)
        entries.append(effect_entry(effect, hidden[effect.name],
                                    truth.of(effect.name, whole - without, effect.special_case_of, effect.also)))
    return entries, force_cells(base)


def effect_entry(effect, values, truth):
    """An effect of an answer."""
    entry = {"name": effect.name, "in_library": effect.in_library, "part": effect.part, "channel": effect.channel,
             "also": list(effect.also), "parameters": {}, "sizes": [], "truth": truth}
    if effect.form:
        entry["form"] = effect.form
    if effect.described_by:
        entry["term_that_describes_it"] = effect.described_by
    for parameter in effect.parameters:
        value = values.get(parameter.name)
        entry["parameters"][parameter.name] = {"value": np.asarray(value).tolist()}
        if parameter.is_size or parameter.name == "limit":
            each = zip(AXES, value) if np.ndim(value) else ((None, value),)
            entry["sizes"] += [{"name": parameter.name, "axis": axis, "value": float(one), "absent": parameter.absent}
                               for axis, one in each if one != parameter.absent]
    return entry


def _floors(test, specimen, hidden, chosen, scales, recorded):
    """Error of the true model, driven by the measured motion, on the unseen record."""
    u = fused(*(np.stack([recorded[f"{quantity}_{letter} [{unit}]"] for letter in "xy"], axis=1)
                for quantity, unit in (("u", "m"), ("a", "m/s2"))), STEP)
    measured = 1e3 * np.stack([recorded[f"F_{letter} [kN]"] for letter in "xy"], axis=1)
    return {"oracle": nrmse(measured, whole_force(test, specimen.values, hidden, chosen, scales, u), STEP),
            "without_effects": nrmse(measured, test.bearing(specimen.values, {}, u), STEP)}

# SPDX-License-Identifier: Apache-2.0
"""Effects that a force shows along a measured motion, by their names in the catalogue (docs/terms.md).

Each has its own equations here, written from the catalogue's formulas and not from its code.
"""
import dataclasses
import math
from collections.abc import Callable

import numpy as np

from motion import presliding, relaxed
from signals import delayed, lagged

LIBRARY, OUTSIDE = "library", "outside"
LEAST_LIMIT = 0.4  # of the largest force: a sensor that saturates below it is no sensor
EITHER_SIGN = True


@dataclasses.dataclass(frozen=True)
class Size:
    """A parameter: `low` to `high` in natural units. A size scales the effect from zero."""
    name: str
    unit: str
    low: float
    high: float
    per_axis: bool = False
    either_sign: bool = False
    is_size: bool = True
    absent: float = 0.0  # the catalogue's value without the effect


@dataclasses.dataclass(frozen=True)
class Effect:
    name: str
    part: str
    parameters: tuple
    act: Callable  # motion, values, force → change of the force
    home: str = LIBRARY
    form: str = ""
    described_by: str = ""  # a term of the catalogue that describes an outsider
    needs: str = ""  # "load", "plane"
    special_case_of: tuple = ()
    also: tuple = ()  # other names of the same equation
    channel: str = "force"

    @property
    def in_library(self):
        return self.home == LIBRARY


def shape(name, unit, low, high, **more):
    return Size(name, unit, low, high, is_size=False, **more)


def _added(law):
    return lambda motion, values, force: law(motion, values)


PRESLIDING = shape("presliding", "U", 0.002, 0.008)


def _dry(motion, values):
    return presliding(motion.u, values["presliding"])


def _rub(motion, values):
    return (values["friction_force"] * _dry(motion, values)
            * np.exp(-((motion.u - values["place"]) / values["width"]) ** 2))


def _stribeck(motion, values):
    extra = values["breakaway_force"] * np.exp(-(motion.v / values["stribeck_velocity"]) ** 2)
    return (values["friction_force"] + extra) * _dry(motion, values)


def _two_sided(motion, values):
    s = _dry(motion, values)
    return np.where(s > 0, values["forward_force"], values["backward_force"]) * s


def _cubic(motion, values):
    return values["stiffness"] * (motion.u**2).sum(axis=1, keepdims=True) * motion.u


def _stiffening(motion, values):
    size = np.sqrt((motion.u**2).sum(axis=1, keepdims=True))
    return values["stiffness"] * np.maximum(0, size - values["onset"]) * motion.u / np.maximum(size, 1e-12)


def machine_effects():
    force = "F"
    return [
        Effect("coulomb_friction", "machine", (Size("friction_force", force, .01, .04, True), PRESLIDING),
               _added(lambda m, p: p["friction_force"] * _dry(m, p)),
               special_case_of=("stribeck_friction", "asymmetric_friction", "bouc_wen", "current_dependent_friction")),
        Effect("viscous_friction", "machine", (Size("coefficient", "F/V", .01, .05, True),),
               _added(lambda m, p: p["coefficient"] * m.v),
               special_case_of=("asymmetric_viscous", "current_dependent_damping"), also=("viscous_damping",)),
        Effect("quadratic_drag", "machine", (Size("coefficient", "F/V2", .015, .06),),
               _added(lambda m, p: p["coefficient"] * np.abs(m.v) * m.v)),
        Effect("load_dependent_friction", "machine", (Size("friction_coefficient", "F/N", .01, .04), PRESLIDING),
               _added(lambda m, p: p["friction_coefficient"] * np.maximum(m.load[:, None], 0) * _dry(m, p)),
               needs="load"),
        Effect("stribeck_friction", "machine",
               (Size("friction_force", force, .01, .03, True), Size("breakaway_force", force, .015, .04),
                shape("stribeck_velocity", "V", .03, .15), PRESLIDING), _added(_stribeck)),
        Effect("asymmetric_friction", "machine",
               (Size("forward_force", force, .02, .05, True), Size("backward_force", force, .005, .015, True),
                PRESLIDING), _added(_two_sided)),
        Effect("position_dependent_friction", "machine",
               (Size("friction_force", force, .02, .06), shape("place", "U", .05, .3, either_sign=EITHER_SIGN),
                shape("width", "U", .1, .25), PRESLIDING), _added(_rub)),
        Effect("asymmetric_viscous", "machine",
               (Size("forward_coefficient", "F/V", .03, .06, True),
                Size("backward_coefficient", "F/V", .005, .015, True)),
               _added(lambda m, p: np.where(m.v > 0, p["forward_coefficient"], p["backward_coefficient"]) * m.v)),
        Effect("platen_inertia", "machine", (Size("mass", "F/A", .01, .05, True),),
               _added(lambda m, p: p["mass"] * m.a)),
    ]


def specimen_effects():
    return [
        Effect("cubic_stiffness", "bearing", (Size("stiffness", "F/U3", .02, .08),), _added(_cubic),
               special_case_of=("polynomial_stiffness",)),
        Effect("asymmetric_stiffness", "bearing",
               (Size("stiffness", "F/U2", .015, .06, True, EITHER_SIGN),),
               _added(lambda m, p: p["stiffness"] * m.u**2), special_case_of=("polynomial_stiffness",)),
        Effect("large_strain_stiffening", "bearing",
               (Size("stiffness", "F/U", .08, .25), shape("onset", "U", .4, .65)), _added(_stiffening)),
        Effect("viscoelastic_relaxation", "bearing",
               (Size("stiffness", "F/U", .03, .1), shape("relaxation_time", "1", .3, 2)),
               _added(lambda m, p: relaxed(m.u, p["stiffness"], p["relaxation_time"], m.step))),
    ]


def _skewed(motion, values, force):
    late = values["skew"] + values.get("rate", 0.0) * motion.t
    return np.stack([delayed(column, late, motion.step) for column in force.T], axis=1) - force


def _slow(motion, values, force):
    return np.stack([lagged(column, values["time_constant"], motion.step) for column in force.T], axis=1) - force


def sensor_effects():
    def fault(name, parameters, act, **more):
        return Effect(name, "sensor", parameters, act, **more)
    return [
        fault("force_gain", (Size("factor", "1", .008, .03, True, EITHER_SIGN, absent=1.0),),
              lambda m, p, f: (p["factor"] - 1) * f),
        fault("force_drift", (Size("rate", "F/T", .01, .04, True, EITHER_SIGN),),
              lambda m, p, f: p["rate"] * m.t[:, None] * np.ones(m.axes)),
        fault("force_saturation", (shape("limit", "F", .75, .92),),
              lambda m, p, f: np.clip(f, -p["limit"], p["limit"]) - f),
        fault("force_skew", (Size("skew", "1", 1e-3, 5e-3),), _skewed, special_case_of=("force_clock_drift",)),
        fault("force_clock_drift", (Size("rate", "1", 1e-4, 3e-4), Size("skew", "1", 0, 0)), _skewed),
        fault("force_filter_lag", (Size("time_constant", "1", 1e-3, 5e-3),), _slow, also=("force_lag",)),
        fault("force_absolute_value_sensor", (Size("share", "1", .01, .05),),
              lambda m, p, f: p["share"] * (np.abs(f) - f)),
        fault("force_crosstalk_horizontal",
              (Size("lat_into_long", "1", .01, .03, False, EITHER_SIGN),
               Size("long_into_lat", "1", .01, .03, False, EITHER_SIGN)),
              lambda m, p, f: f[:, ::-1] * np.array([p["lat_into_long"], p["long_into_lat"]]), needs="plane"),
        fault("force_crosstalk_vertical", (Size("share", "F/N", .01, .04, True, EITHER_SIGN),),
              lambda m, p, f: p["share"] * (m.load - m.load.mean())[:, None], needs="load"),
    ]


def _held(motion, values, force):
    """Bursts of samples that repeat the last one; their places follow from a size, not from a random number."""
    out = force.copy()
    length = max(2, round(0.03 / motion.step))
    every = max(2 * length, round(length / values["share"]))
    for begin in range(every // 2, len(out) - length, every):
        out[begin:begin + length] = out[begin - 1]
    return out - force


def outside_effects():
    def outsider(name, part, form, parameters, law, described_by="", **more):
        return Effect(name, part, parameters, _added(law), OUTSIDE, form, described_by, **more)
    return [
        outsider("cogging", "machine", "periodic in displacement",
                 (Size("force", "F", .01, .04), shape("pitch", "U", .08, .25), shape("phase", "1", 0, 6)),
                 lambda m, p: p["force"] * np.sin(2 * math.pi * m.u / p["pitch"] + p["phase"]), "cogging"),
        outsider("pump_ripple", "machine", "external periodic force",
                 (Size("force", "F", .01, .03), shape("frequency", "1", 3, 10), shape("phase", "1", 0, 6)),
                 lambda m, p: (p["force"] * np.sin(2 * math.pi * p["frequency"] * m.t + p["phase"]))[:, None]
                 * np.ones(m.axes)),
        outsider("gyroscopic", "machine", "f(v of the other axis)",
                 (Size("coefficient", "F/V", .02, .06, False, EITHER_SIGN),),
                 lambda m, p: p["coefficient"] * m.v[:, ::-1] * np.array([1, -1]), needs="plane"),
        outsider("cross_axis_ratchet", "machine", "f(v_long v_lat)",
                 (Size("force", "F", .015, .05, False, EITHER_SIGN), shape("velocity", "V", .2, .5)),
                 lambda m, p: p["force"] * np.tanh(m.v.prod(axis=1) / p["velocity"] ** 2)[:, None] * np.ones(2),
                 needs="plane"),
        outsider("wearing_guide", "machine", "sgn(v) g(path)",
                 (Size("force", "F", .02, .06), PRESLIDING),
                 lambda m, p: p["force"] * _dry(m, p) * _path(m)),
        Effect("dropout", "sensor", (shape("share", "1", .01, .03),), _held, OUTSIDE, "held samples"),
    ]


def _path(motion):
    """Path so far over the whole path."""
    whole = np.cumsum(np.abs(motion.v).sum(axis=1))[:, None]
    return whole / whole[-1]


def all_effects():
    return machine_effects() + specimen_effects() + sensor_effects() + outside_effects()


def usable(motion):
    """Effects that this motion can show. On one axis, the stop of the catalogue has the law of a stiffening."""
    missing = ({"load"} if motion.load is None else set()) | ({"plane"} if motion.axes < 2 else set())
    return [dataclasses.replace(effect, also=("gap_contact",))
            if motion.axes == 1 and effect.name == "large_strain_stiffening" else effect
            for effect in all_effects() if effect.needs not in missing]


def draw(effect, motion, rng, size):
    """Values of the effect's parameters, `size` times the standard ones."""
    values = {}
    for parameter in effect.parameters:
        shape_of = motion.axes if parameter.per_axis else None
        value = rng.uniform(parameter.low, parameter.high, shape_of) * motion.scale(parameter.unit)
        if parameter.either_sign:
            value = value * rng.choice([-1, 1], shape_of)
        if parameter.is_size:
            value = size * value
        values[parameter.name] = value + parameter.absent
    if effect.name == "force_saturation":
        values["limit"] = motion.scale("F") * max(LEAST_LIMIT, 1 - size * (1 - values["limit"] / motion.scale("F")))
    return values


def columns_of(effect, motion, force):
    """Signatures of a rival: for several shapes, a list of changes of the force, one of each free size."""
    return [[effect.act(motion, values, force) for values in alternative] for alternative in alternatives_of(effect, motion)]


def alternatives_of(effect, motion):
    """For several shapes, a list of values in which one size alone is not absent."""
    alternatives = []
    shapes = [p for p in effect.parameters if not p.is_size]
    for share in ((0.15, 0.5, 0.85) if shapes else (0.5,)):
        base = {p.name: (p.low + share * (p.high - p.low)) * motion.scale(p.unit) for p in shapes}
        alternatives.append(_one_size_each(effect, motion, base))
    return alternatives


def _one_size_each(effect, motion, base):
    sizes = [p for p in effect.parameters if p.is_size]
    if not sizes:
        return [base]
    rows = []
    for parameter in sizes:
        value = (parameter.low + parameter.high) / 2 * motion.scale(parameter.unit)
        for axis in range(motion.axes) if parameter.per_axis else (None,):
            values = base | {p.name: np.full(motion.axes, p.absent) if p.per_axis else p.absent for p in sizes}
            on = 1.0 if axis is None else 1.0 * (np.arange(motion.axes) == axis)
            values[parameter.name] = values[parameter.name] + value * on
            if value:
                rows.append(values)
    return rows


def combined(effect, rows, coefficients):
    """Values with all sizes at once: those of `rows`, each times its coefficient."""
    values = dict(rows[0])
    for parameter in (p for p in effect.parameters if p.is_size):
        parts = [c * (row[parameter.name] - parameter.absent) for row, c in zip(rows, coefficients)]
        values[parameter.name] = parameter.absent + sum(parts)
    return values


def vector_of(effect, values):
    """All parameters, sizes without their absent value."""
    return np.concatenate([np.atleast_1d(values[p.name] - (p.absent if p.is_size else 0)) for p in effect.parameters])


def values_of(effect, vector, motion):
    values, at = {}, 0
    for p in effect.parameters:
        count = motion.axes if p.per_axis else 1
        part = vector[at:at + count]
        values[p.name] = (part if p.per_axis else float(part[0])) + (p.absent if p.is_size else 0)
        at += count
    return values

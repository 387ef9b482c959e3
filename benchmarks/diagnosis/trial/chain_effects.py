# SPDX-License-Identifier: Apache-2.0
"""Effects on a chain of masses: in a spring, at the input or at an output, by their names in the catalogue."""
import dataclasses
from collections.abc import Callable

import numpy as np

from signals import delayed, lagged

SPRING, INPUT, OUTPUT = "spring", "input", "output"


@dataclasses.dataclass(frozen=True, eq=False)
class ChainEffect:
    """`parameters`: the catalogue's name → (natural unit, low, high, either sign, is it a size).

    `keys` are the chain's names of the parameters; `act` changes a signal at the input or at an output.
    """
    name: str
    where: str
    parameters: dict
    keys: tuple = ()
    act: Callable | None = None
    in_library: bool = True
    form: str = ""
    described_by: str = ""
    special_case_of: tuple = ()
    also: tuple = ()
    part: str = "structure"


def size(unit, low, high, either_sign=False):
    return unit, low, high, either_sign, True


def shape(unit, low, high, either_sign=False):
    return unit, low, high, either_sign, False


PRESLIDING = shape("U", .004, .015)


def spring_effects():
    def one(name, parameters, keys, **more):
        return ChainEffect(name, SPRING, parameters, keys, **more)
    return [
        one("cubic_stiffness", {"stiffness": size("F/U3", .03, .12)}, ("cubic",)),
        one("asymmetric_stiffness", {"stiffness": size("F/U2", .03, .12, True)}, ("quadratic",)),
        one("large_strain_stiffening", {"stiffness": size("F/U", .15, .5), "onset": shape("U", .4, .65)},
            ("stiffening", "onset"), also=("piecewise_stiffness", "gap_contact")),
        one("viscoelastic_relaxation", {"stiffness": size("F/U", .08, .2), "relaxation_time": shape("1", .05, .5)},
            ("branch", "relaxation")),
        one("bouc_wen", {"characteristic_strength": size("F", .05, .15), "yield_displacement": shape("U", .1, .3)},
            ("strength", "yield"), also=("bouc_wen_nagarajaiah",)),
        one("transducer_backlash", {"gap": size("U", .03, .1)}, ("gap",)),
        one("quadratic_drag", {"coefficient": size("F/V2", .03, .1)}, ("drag",)),
        one("coulomb_friction", {"friction_force": size("F", .02, .08), "presliding": PRESLIDING}, ("dry", "presliding"),
            special_case_of=("stribeck_friction", "asymmetric_friction")),
        one("asymmetric_friction", {"forward_force": size("F", .04, .08), "backward_force": size("F", .01, .02),
                                    "presliding": PRESLIDING}, ("dry_forward", "dry_backward", "presliding")),
        one("asymmetric_viscous", {"forward_coefficient": size("F/V", .06, .15), "backward_coefficient": size("F/V", 0, .02)},
            ("forward", "backward")),
        one("piecewise_damping", {"slow_coefficient": size("F/V", .2, .5), "break_velocity": shape("V", .08, .2)},
            ("slow", "break")),
    ]


def at_outputs(placed):
    """Of placed effects, those at outputs in the order in which they act: a converter overflows after all others."""
    return sorted((one for one in placed if one.effect.where == OUTPUT), key=lambda one: one.effect.name == "overflow")


def _overflowed(y, values):
    return y - 2 * values["limit"] * np.round(y / (2 * values["limit"]))


def signal_effects():
    at_input = [
        ChainEffect("saturation", INPUT, {"limit": shape("I", .5, .8)},
                    act=lambda x, p, step: np.clip(x, -p["limit"], p["limit"])),
        ChainEffect("actuator_delay", INPUT, {"delay": size("1", .005, .02)},
                    act=lambda x, p, step: delayed(x, p["delay"], step)),
        ChainEffect("first_order_lag", INPUT, {"time_constant": size("1", .005, .02)},
                    act=lambda x, p, step: lagged(x, p["time_constant"], step), special_case_of=("actuator_bandwidth",)),
        ChainEffect("input_dead_zone", INPUT, {"half_width": size("I", .03, .1)},
                    act=lambda x, p, step: x - np.clip(x, -p["half_width"], p["half_width"])),
        ChainEffect("absolute_value_sensor", INPUT, {"share": size("1", .05, .2)},
                    act=lambda x, p, step: (1 - p["share"]) * x + p["share"] * np.abs(x)),
    ]
    at_input.append(ChainEffect("gain", INPUT, {"factor": size("1", .02, .08, True)}, act=lambda x, p, step: p["factor"] * x))
    at_output = [
        ChainEffect("gain", OUTPUT, {"factor": size("1", .02, .08, True)}, act=lambda y, p, step: p["factor"] * y),
        ChainEffect("drift", OUTPUT, {"rate": size("O/T", .03, .1, True)},
                    act=lambda y, p, step: y + p["rate"] * step * np.arange(len(y))),
        ChainEffect("saturation", OUTPUT, {"limit": shape("O", .65, .88)},
                    act=lambda y, p, step: np.clip(y, -p["limit"], p["limit"])),
        ChainEffect("time_skew", OUTPUT, {"skew": size("1", .004, .015)},
                    act=lambda y, p, step: delayed(y, p["skew"], step)),
        ChainEffect("filter_lag", OUTPUT, {"time_constant": size("1", .004, .015)},
                    act=lambda y, p, step: lagged(y, p["time_constant"], step)),
        ChainEffect("overflow", OUTPUT, {"limit": shape("O", .85, .95)}, act=lambda y, p, step: _overflowed(y, p)),
    ]
    return at_input + at_output


def outsiders():
    def one(name, parameters, keys, form, where=SPRING, described_by="", **more):
        return ChainEffect(name, where, parameters, keys, in_library=False, form=form, described_by=described_by, **more)
    return [
        one("cogging", {"force": size("F", .02, .06), "pitch": shape("U", .1, .3)}, ("cogging", "pitch"),
            "periodic in displacement", described_by="cogging"),
        one("pump_ripple", {"force": size("P", .03, .1), "frequency": shape("1", 2, 8)}, ("ripple", "ripple_Hz"),
            "external periodic force", described_by="mass"),
        one("damage_step", {"share": size("1", -.15, -.05), "time": shape("T", .35, .65)}, ("change", "change_time"),
            "change of stiffness at a time", described_by="all"),
        one("dropout", {"share": shape("1", .01, .03)}, (), "held samples", OUTPUT,
            act=lambda y, p, step: _held(y, p["share"], step)),
    ]


def _held(y, share, step):
    out, length = y.copy(), max(2, round(0.05 / step))
    every = max(2 * length, round(length / share))
    for begin in range(every // 2, len(y) - length, every):
        out[begin:begin + length] = out[begin - 1]
    return out

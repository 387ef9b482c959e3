# SPDX-License-Identifier: Apache-2.0
"""Compares the sizes of effects: the generator's parameters with the tool's.

Only parameters that both have are compared, and only those that scale an effect from zero.
"""
import dataclasses
import re

PLATEN_MASS = {"long": 113.3e3, "lat": 116.8e3}  # as case.toml states it [kg]
RECORD_LENGTH = 40  # reference time of the generator's drifts [s]
TRANSPORT_DELAY = 4e-3  # as case.toml states it [s]
SERVO_TIME = 0.0132629  # as case.toml states it [s]
HEIGHT = 0.37  # of p_delta, default in the catalogue [m]


@dataclasses.dataclass(frozen=True)
class Size:
    """One size of an effect: the tool's value is `absent` + `factor` × the generator's."""

    effect: str
    ours: str  # of the generator; ends with the axis if it has one
    theirs: str  # of the tool's term
    factor: float = 1
    absent: float = 0  # the tool's value without the effect


def _axes(effect, ours, theirs, factor=1, absent=0):
    return [Size(effect, f"{ours}_{axis}", theirs, factor, absent) for axis in ("long", "lat")]


SIZES = [
    Size("axial_load_strength", "axial_strength", "coefficient"),
    Size("axial_load_stiffness", "axial_stiffness", "coefficient"),
    Size("p_delta", "p_delta", "coefficient", HEIGHT),
    Size("bidirectional_coupling", "coupling", "coupling"),
    Size("large_strain_stiffening", "stiffening", "stiffness"),
    Size("cubic_stiffness", "cubic", "stiffness"),
    Size("scragging", "scragging", "virgin_excess"),
    Size("rate_dep_strength", "rate", "coefficient"),
    Size("viscoelastic_relax", "branch_stiffness", "stiffness"),
    *_axes("asymmetric_stiffness", "quadratic", "stiffness"),
    *_axes("coulomb_friction", "friction", "friction_force"),
    *_axes("viscous_friction", "viscous", "coefficient"),
    Size("quadratic_drag", "drag", "coefficient"),
    Size("load_dep_friction", "friction_coefficient", "friction_coefficient"),
    *_axes("stribeck_breakaway", "friction", "friction_force"),
    Size("stribeck_breakaway", "breakaway_force", "breakaway_force"),
    Size("position_dependent_friction", "rub_force", "friction_force"),
    Size("platen_inertia", "mass_error_long", "mass", PLATEN_MASS["long"], PLATEN_MASS["long"]),
    Size("platen_inertia", "mass_error_lat", "mass", PLATEN_MASS["lat"], PLATEN_MASS["lat"]),
    Size("support_flexibility", "flexibility", "flexibility"),
    Size("transducer_backlash", "gap", "gap"),
    Size("mount_slack", "slack", "slack"),
    *_axes("loadcell_drift", "drift", "rate", 1 / RECORD_LENGTH),
    *_axes("loadcell_gain", "gain_error", "factor", 1, 1),
    Size("loadcell_saturation", "limit", "limit"),
    Size("crosstalk_horizontal", "lat_into_long", "lat_into_long"),
    Size("crosstalk_horizontal", "long_into_lat", "long_into_lat"),
    *_axes("crosstalk_vertical", "vertical_into", "share"),
    Size("force_time_skew", "skew", "skew"),
    Size("clock_drift", "clock_rate", "rate"),
    Size("filter_lag", "lag", "time_constant"),
    Size("absolute_value_sensor", "rectified_share", "share"),
    Size("quantisation", "force_step", "step"),
    *_axes("accelerometer_tilt", "tilt", "tilt_per_displacement"),
    *_axes("accelerometer_gain", "acceleration_gain_error", "factor", 1, 1),
    *_axes("accelerometer_drift", "acceleration_drift", "rate", 1 / RECORD_LENGTH),
    Size("actuator_delay", "extra_delay", "delay", 1, TRANSPORT_DELAY),
    Size("rate_saturation", "speed_limit", "velocity_limit"),
    Size("valve_deadband", "dead_band", "dead_band"),
    Size("oil_column_resonance", "oil_time_constant", "time_constant"),
    Size("load_compliance", "compliance", "compliance"),
]


def _axis_of(name):
    words = re.split(r"[._\[\]]", name)
    return next((axis for axis in ("long", "lat") if words and axis in words), None)


def _expected(size, value, answer, said):
    """The tool's expected value, and its value without the effect."""
    if size.effect == "p_delta" and "height" in said:
        return value * said["height"]["value"], 0
    return size.absent + size.factor * value, size.absent


def _special(effect, answer):
    """Sizes with a conversion other than a factor: (generator's name, tool's name, expected, absent)."""
    values = {name: row["value"] for name, row in effect["parameters"].items()}
    if effect["name"] == "lead_heating":
        # The tool has exp(-b W) of the work W, the generator exp(-β s) of the path s = W / Q.
        strength = answer["specimen"]["characteristic_strength"]["value"]
        yield "heating", "softening", values["heating"] / strength, 0
    if effect["name"] == "asymmetric_friction":
        for axis in ("long", "lat"):
            mean, more = values[f"friction_{axis}"], values[f"forward_minus_mean_{axis}"]
            yield f"friction_{axis}", "forward_force", mean + more, 0
            yield f"friction_{axis}", "backward_force", mean - more, 0
    if effect["name"] == "actuator_bandwidth":
        yield "bandwidth_factor", "time_constant", SERVO_TIME / values["bandwidth_factor"], SERVO_TIME


def _wanted(effect, answer, said):
    for size in SIZES:
        if size.effect == effect["name"]:
            value = effect["parameters"][size.ours]["value"]
            yield (size.ours, size.theirs, *_expected(size, value, answer, said))
    yield from _special(effect, answer)


def _stated(effect, cause):
    """Rows of an effect whose answer names its sizes as the catalogue does. A cause on one axis is compared there."""
    rows, only = [], _axis_of_title(cause)
    for size in effect["sizes"]:
        if only and size["axis"] not in (None, only):
            continue
        for name, row in cause["parameters"].items():
            if name.rsplit(".", 1)[-1] == size["name"] and _axis_of(name) in (None, size["axis"]) and row["value"] is not None:
                rows.append(_row(name, row, size["value"] / _gain_of_the_other(effect, size, only), size["absent"]))
                break
    return rows


def _axis_of_title(cause):
    """The axis of a cause that acts on one alone: "gain error of a sensor (force), lat axis"; else None."""
    found = re.search(r", (long|lat) axis$", cause.get("title", ""))
    return found and found[1]


def _gain_of_the_other(effect, size, only):
    """A gain on one axis alone is relative to that of the other, which the fitted forces of the model have taken over."""
    if only is None or size["absent"] != 1:
        return 1
    return next((other["value"] for other in effect["sizes"] if other["name"] == size["name"] and other["axis"] not in (None, only)), 1)


def _row(name, row, expected, absent):
    low, high = row.get("ci95") or (None, None)
    return {"name": name, "truth": expected, "value": row["value"], "low": low, "high": high,
            "error": abs(row["value"] - expected) / abs(expected - absent),
            "covered": None if None in (low, high) else low <= expected <= high}


def compare(effect, answer, cause):
    """Rows {name, truth, value, low, high, error, covered} of the sizes that effect and cause share.

    @param cause  of the tool: its title, and its parameters {"term.parameter": {"value", "ci95", "unit"}}
    """
    if "sizes" in effect:
        return _stated(effect, cause)
    parameters = cause["parameters"]
    said = {name.rsplit(".", 1)[-1]: row for name, row in parameters.items()}
    rows = []
    for ours, theirs, expected, absent in _wanted(effect, answer, said):
        axis = _axis_of(ours) if ours not in ("lat_into_long", "long_into_lat") else None
        for name, row in parameters.items():
            if name.rsplit(".", 1)[-1] != theirs or (axis and _axis_of(name) != axis):
                continue
            if row["value"] is None:
                break
            rows.append(_row(name, row, expected, absent))
            break
    return rows

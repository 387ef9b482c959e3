# SPDX-License-Identifier: Apache-2.0
"""Names of the same effect in the generator and in the tool.

The generator names effects. The tool names terms of its catalogue (docs/terms.md) or the fault of a
channel, such as "force_gain".
"""
import re

# name of the generator: other names of the tool
SYNONYMS = {
    "load_dep_friction": ["load_dependent_friction"],
    "stribeck_breakaway": ["stribeck_friction"],
    "viscoelastic_relax": ["viscoelastic_relaxation"],
    "lead_heating": ["adiabatic_heating"],
    "viscous_friction": ["viscous_damping"],  # the same equation, in another part
    "loadcell_drift": ["force_drift"],
    "loadcell_gain": ["force_gain"],
    "loadcell_saturation": ["force_saturation"],
    "crosstalk_horizontal": ["force_crosstalk_horizontal"],
    "crosstalk_vertical": ["force_crosstalk_vertical"],
    "force_time_skew": ["force_skew"],
    "clock_drift": ["force_clock_drift"],
    "filter_lag": ["force_filter_lag", "force_lag"],
    "absolute_value_sensor": ["force_absolute_value_sensor", "force_absolute_value"],
    "quantisation": ["force_quantisation"],
    "accelerometer_tilt": ["acceleration_tilt"],
    "accelerometer_gain": ["acceleration_gain"],
    "accelerometer_drift": ["acceleration_drift"],
}
_OF_TOOL = {theirs: ours for ours, others in SYNONYMS.items() for theirs in others}

# Forms of unnamed effects: the generator's spelling and others.
FORMS = {
    "periodic in displacement": ["periodic f(u)", "f(u) periodic", "f(u), periodic"],
    "sgn(v) g(u)": [],
    "change of strength at a time": ["change of strength", "strength step", "change point"],
    "f(v)": ["v g(v)"],
    "external periodic force": ["spectral line"],
    "f(v_long v_lat)": ["f(v_x v_y)"],
    "f(v of the other axis)": ["f(v_other)", "f(v_lat), f(v_long)"],
    "sgn(v) g(path)": ["sgn(v) g(t)"],
    "f(u_long, u_lat)": ["f(u, u_other)", "g(u_long, u_lat)"],
    "held samples": ["dropout", "samples held"],
}


def terms_of(verdict):
    """Causes and guesses: the terms of the improved simulation."""
    return [*verdict["causes"], *verdict.get("guesses", [])]


def canonical(name):
    """The generator's name for a name of the tool."""
    return _OF_TOOL.get(name, name)


def _plain(form):
    """A form in lower case without blanks, without the number of a frequency, a time or a parameter."""
    plain = re.sub(r" at [\d.]+ hz$", "", form.lower())
    plain = re.sub(r"^change of \S*(stiffness|denominator)\S* at [\d.]+ s$", "change of stiffness at a time", plain)
    plain = re.sub(r"^change of \S*strength\S* at [\d.]+ s$", "change of strength at a time", plain)
    return re.sub(r"[\s*·]+", "", plain)


def _without_place(form, component):
    """A form without the tool's words for the component: a spring of a chain, or the only one (None)."""
    if component is None:
        return re.sub(r" from \S+ back to \S+$", "", form)
    if component.startswith("port."):
        return form.removesuffix(f" at {component}")
    number = re.fullmatch(r"spring\.(\d+)", component)
    if number is None:
        return form
    mass = int(number[1])
    return form.removesuffix(" between mass 1 and the ground" if mass == 1 else f" between masses {mass - 1} and {mass}")


def is_form(said, wanted, component=None):
    """Whether a form is the generator's. A form that names a place must name that of the component."""
    return _plain(_without_place(said, component)) in {_plain(form) for form in [wanted, *FORMS.get(wanted, [])]}

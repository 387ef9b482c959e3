# SPDX-License-Identifier: Apache-2.0
"""What the generator of trials and the tool call the same things.

The generator names effects, the tool names terms of its catalogue (docs/terms.md), or what is wrong
with a channel: "force_gain". Everything that has to be known of both stands here.
"""
import re

# name of the generator: what the tool may call it besides
SYNONYMS = {
    "load_dep_friction": ["load_dependent_friction"],
    "stribeck_breakaway": ["stribeck_friction"],
    "viscoelastic_relax": ["viscoelastic_relaxation"],
    "lead_heating": ["adiabatic_heating"],
    "viscous_friction": ["viscous_damping"],  # the same equation, of another part
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

# Forms of what has no name: those of the generator, and how else they may be written.
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


def canonical(name):
    """The generator's name of what the tool names."""
    return _OF_TOOL.get(name, name)


def _plain(form):
    return re.sub(r"[\s*·]+", "", form.lower())


def is_form(said, wanted):
    """Whether a form is the one that the generator says."""
    return _plain(said) in {_plain(form) for form in [wanted, *FORMS.get(wanted, [])]}



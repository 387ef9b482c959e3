# SPDX-License-Identifier: Apache-2.0
"""A case as a linear regression: terms of the model, and a library of the trial's effects, as columns.

Forces: measured force against columns along the measured motion. Masses on springs: the balance of forces of each
mass from differentiated outputs, as SINDy forms it.
"""
import dataclasses
import pathlib
import re
import tomllib

import numpy as np

import chain_effects
import effects
from motion import Motion, bouc_wen, presliding, sliding
from recordings import _stop
from signals import fused, low_passed, rate_of

RATE_HZ = 250.0  # of the regression, at most
SMOOTH_HZ = 25.0  # of measured motion, before it is differentiated
AXES = ("long", "lat")
TO_SI = {"kN": 1e3, "N": 1.0, "m": 1.0, "m/s2": 1.0, "s": 1.0}


@dataclasses.dataclass
class Column:
    """One candidate: the effect's name, its component, its size and the size's value in this column."""
    name: str
    component: str | None
    parameter: str
    value: float
    axis: str | None
    signals: list  # flat, of each record


@dataclasses.dataclass
class Problem:
    targets: list  # flat, of each record
    base: list  # of each record: samples × columns
    library: list  # of columns


def _table(folder, file, channels):
    with open(folder / file) as lines:
        names = lines.readline().strip().split(",")
    values = np.genfromtxt(folder / file, delimiter=",", skip_header=1)
    # Rows without time: as if they were sampled at the rate of all others.
    found = {"time": np.arange(len(values)) / RATE_HZ} if channels["time"] == "none" else {}
    for role, source in channels.items():
        if source == "none":
            continue
        name, unit = re.fullmatch(r"(.*) \[(.*)\]", source).groups()
        column = names.index(source) if source in names else names.index(name)
        found[role] = TO_SI[unit] * values[:, column]
    return found


def _flat(channels):
    """Roles as in case.toml: "displacement.long"."""
    roles = {}
    for key, value in channels.items():
        roles |= {f"{key}.{axis}": source for axis, source in value.items()} if isinstance(value, dict) else {key: value}
    return roles


def read(folder):
    """case.toml and the records to fit, held out and unseen, thinned: role → samples, and their step."""
    case = tomllib.loads((folder / "case.toml").read_text())
    records = []
    for record in (row for row in case["record"] if row["use"] != "reference"):
        table = _table(folder, record["file"], _flat(case["channels"]))
        step = float(np.median(np.diff(table["time"])))
        every = max(1, round(1 / (RATE_HZ * step)))
        if every > 1:
            table = {role: low_passed(values, 0.4 / (every * step), step)[::every] for role, values in table.items()}
        records.append((every * step, table))
    return case["model"], records


def problem_of(folder):
    model, records = read(pathlib.Path(folder))
    if model["kind"] in ("platen", "bearing"):
        return _of_forces(model, records)
    return _of_chain(model, records)


def _motions(records):
    motions, scales = [], None
    for step, table in records:
        axes = [axis for axis in AXES if f"force.{axis}" in table]
        u = np.stack([table[f"displacement.{axis}"] for axis in axes], axis=1)
        if f"acceleration.{axes[0]}" in table:
            u = fused(u, np.stack([table[f"acceleration.{axis}"] for axis in axes], axis=1), step)
        else:
            u = low_passed(u, SMOOTH_HZ, step)
        v = rate_of(u, step)
        force = np.stack([table[f"force.{axis}"] for axis in axes], axis=1)
        motions.append(Motion(step, u, v, rate_of(v, step), table.get("vertical_force"), force, scales))
        scales = scales or motions[0].peaks()
    return motions


def _term_columns(motion, name, term):
    """Signals that a term of the model may move, samples × axes each."""
    if name.startswith("bouc_wen"):
        size = term["yield_displacement_m"]
        return [motion.u] + [bouc_wen(motion.u, share * size, pieces=2) for share in (.85, 1.0, 1.15)]
    if name in ("flat_slider", "single_pendulum"):
        load = np.maximum(motion.load, 0)[:, None]
        slip = term["friction_coefficient"] * motion.load.mean() / term["initial_stiffness_N_per_m"]
        return [load * sliding(motion.u, slip)] + ([load * motion.u] if name == "single_pendulum" else [])
    if name == "coulomb_friction":
        return [presliding(motion.u, term.get("presliding_m", 1e-4))]
    if name == "asymmetric_hysteresis":
        lengths = {"forward_length": term["forward_length_m"], "backward_length": term["backward_length_m"],
                   "play": term["play_m"], "viscous": 0.0}
        return [_stop(motion, lengths | {"forward": 1.0, "backward": 0.0}), _stop(motion, lengths | {"forward": 0.0, "backward": 1.0})]
    simple = {"viscous_friction": [motion.v], "asymmetric_viscous": [np.maximum(motion.v, 0), np.minimum(motion.v, 0)],
              "platen_inertia": [motion.a], "polynomial_stiffness": [motion.u], "force_offset": [np.ones_like(motion.u)]}
    return simple.get(name, [])


def _of_forces(model, records):
    motions = _motions(records)
    base = []
    for motion in motions:
        columns = [_each_axis(column) for name, term in model.items() if isinstance(term, dict)
                   for column in _term_columns(motion, name, term)]
        base.append(np.concatenate(columns, axis=1))
    targets = [m.force.T.ravel() for m in motions]
    fitted = np.linalg.lstsq(base[0], targets[0], rcond=1e-9)[0]
    # Faults of the load cell act on the force of the model, which is not measured.
    motions = [dataclasses.replace(m, force=(block @ fitted).reshape(m.axes, -1).T) for m, block in zip(motions, base)]
    library = []
    for effect in (e for e in effects.usable(motions[0]) if e.in_library and e.name not in model):
        rows = effects.alternatives_of(effect, dataclasses.replace(motions[0], scales=None))
        library += [_column(effect, values, motions) for alternative in rows for values in alternative]
    return Problem(targets, base, library)


def _each_axis(signal):
    """One flat column for each axis: the parameters of axes are independent."""
    columns = []
    for axis in range(signal.shape[1]):
        alone = np.zeros_like(signal)
        alone[:, axis] = signal[:, axis]
        columns.append(alone.T.ravel())
    return np.stack(columns, axis=1)


def _column(effect, values, motions):
    parameter, value, axis = None, 0.0, None
    for p in (p for p in effect.parameters if p.is_size):
        sizes = np.atleast_1d(values[p.name]) - p.absent
        if np.any(sizes):
            at = int(np.argmax(np.abs(sizes)))
            parameter, value, axis = p, float(sizes[at]), AXES[at] if p.per_axis else None
    signals = [effect.act(m, values, m.force).T.ravel() for m in motions]
    return Column(effect.name, None, parameter.name if parameter else "", value, axis, signals)


def _of_chain(model, records):
    """None if a displacement between the first and the last mass is missing."""
    if model["kind"] == "linear":
        inverse = 1 / model["numerator"][0]
        masses, outputs = [inverse], ["output.y1"]
    else:
        masses = model["masses_kg"]
        by_mass = {target: role for role, target in model["outputs"].items()}
        outputs = [by_mass.get(f"displacement.{k + 1}") for k in range(len(masses))]
    if None in outputs:
        return None
    is_ground = "base_acceleration" in model.get("inputs", {}).values()
    balance = _Balance(np.array(masses), outputs, is_ground, records)
    return Problem(balance.targets(), balance.base(), balance.library())


class _Balance:
    """p_i − m_i a_i = f_i − f_(i+1), stacked over masses."""

    def __init__(self, masses, outputs, is_ground, records):
        self.m, self.is_ground = masses, is_ground
        self.records = []
        for step, table in records:
            raw = np.stack([table[role] for role in outputs], axis=1)
            self.records.append((step, raw, low_passed(table["input.u"], SMOOTH_HZ, step)))
        step, raw, push = self.records[0]
        d, v = self._deformation(low_passed(raw, SMOOTH_HZ, step), step)
        force = np.abs(self.m.sum() * rate_of(v, step)).max(axis=0)
        self.scales = [{"F": max(force[i], 1e-12), "U": np.abs(d).max(axis=0)[i], "V": np.abs(v).max(axis=0)[i],
                        "I": np.abs(push).max(), "O": np.abs(raw).max(axis=0)[i], "T": step * len(push), "1": 1.0}
                       for i in range(len(masses))]

    @staticmethod
    def _deformation(u, step):
        d = np.diff(u, axis=1, prepend=0.0)
        return d, rate_of(d, step)

    def _load(self, push):
        spread = -self.m if self.is_ground else np.eye(len(self.m))[-1]
        return push[:, None] * spread

    def targets(self):
        return [(self._load(push) - self.m * rate_of(rate_of(low_passed(raw, SMOOTH_HZ, step), step), step)).T.ravel()
                for step, raw, push in self.records]

    def _in_balance(self, force, spring):
        """A force of one spring in the equations of its two masses."""
        rows = np.zeros((len(force), len(self.m)))
        rows[:, spring] += force
        if spring > 0:
            rows[:, spring - 1] -= force
        return rows.T.ravel()

    def base(self):
        blocks = []
        for step, raw, _ in self.records:
            d, v = self._deformation(low_passed(raw, SMOOTH_HZ, step), step)
            blocks.append(np.stack([self._in_balance(signal[:, i], i) for i in range(len(self.m)) for signal in (d, v)], axis=1))
        return blocks

    def library(self):
        from systems import natural
        columns = []
        laws = {"cubic_stiffness": lambda d, v, p: d**3, "asymmetric_stiffness": lambda d, v, p: d * d,
                "quadratic_drag": lambda d, v, p: np.abs(v) * v,
                "coulomb_friction": lambda d, v, p: presliding(d[:, None], p["presliding"])[:, 0],
                "large_strain_stiffening": lambda d, v, p: np.sign(d) * np.maximum(0, np.abs(d) - p["onset"]),
                "asymmetric_viscous": lambda d, v, p: np.maximum(v, 0),
                "bouc_wen": lambda d, v, p: bouc_wen(d[:, None], p["yield_displacement"], pieces=2)[:, 0]}
        for effect in (e for e in chain_effects.spring_effects() if e.name in laws):
            size = next(name for name, p in effect.parameters.items() if p[4])
            for spring in range(len(self.m)):
                values = {name: (low + high) / 2 * natural(unit, self.scales[spring])
                          for name, (unit, low, high, _, _) in effect.parameters.items()}
                signals = []
                for step, raw, _ in self.records:
                    d, v = self._deformation(low_passed(raw, SMOOTH_HZ, step), step)
                    signals.append(self._in_balance(laws[effect.name](d[:, spring], v[:, spring], values), spring))
                columns.append(Column(effect.name, f"spring.{spring + 1}", size, 1.0, None, signals))
        return columns + self._of_input(natural)

    def _of_input(self, natural):
        columns = []
        for effect in (e for e in chain_effects.signal_effects() if e.where == chain_effects.INPUT):
            values = {name: (low + high) / 2 * natural(unit, self.scales[0])
                      for name, (unit, low, high, _, _) in effect.parameters.items()}
            size = next(iter(values))
            signals = [-(self._load(effect.act(push, values, step) - push)).T.ravel() for step, _, push in self.records]
            columns.append(Column(effect.name, "input.u", size, values[size], None, signals))
        return columns

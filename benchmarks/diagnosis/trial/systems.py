# SPDX-License-Identifier: Apache-2.0
"""General dynamic systems: masses on springs and transfer functions, computed by the trial's own Runge-Kutta, and
small isolated frames under recorded earthquakes, computed by OpenSees."""
import dataclasses

import numpy as np

import chain_effects
from chain import Chain
from chain_effects import INPUT, OUTPUT, SPRING, at_outputs
from case_folder import write_case
from signals import colour, random_sines, swell
from slots import effects_for
from truth import cells_of, truth_of
from whitening import Whitener

STEP = 0.01  # [s]
DURATION = 13.0  # [s]
REST_S = 2.0
CUTOFF = 25.0  # of the truth [Hz]; the systems respond below 10 Hz
SUBSTEPS, COARSE = 4, 2  # of records, of the truth
FILES = ("fit.csv", "second.csv", "unseen.csv")


@dataclasses.dataclass
class Placed:
    """An effect, the number of its spring or output, and its values by the catalogue's names."""
    effect: chain_effects.ChainEffect
    at: int
    values: dict


@dataclasses.dataclass
class System:
    masses: np.ndarray
    k: np.ndarray
    c: np.ndarray
    outputs: list  # numbers of the masses whose displacement is recorded
    is_ground: bool = False

    def variant(self, placed=(), **changed):
        """Parameters of the chain with the effects of its springs."""
        variant = {"masses": self.masses, "k": self.k, "c": self.c} | changed
        for one in (p for p in placed if p.effect.where == SPRING):
            for key, value in zip(one.effect.keys, one.values.values()):
                is_one = one.effect.described_by in ("mass", "all")
                at = np.arange(len(self.k)) == one.at
                default = 1.0 if key in ("onset", "presliding", "yield", "relaxation", "pitch", "break", "stribeck") else 0.0
                variant[key] = value if is_one else np.where(at, value, variant.get(key, default))
            if one.effect.name == "pump_ripple":
                variant["ripple_mass"] = one.at
        return variant

    def respond(self, pushes, variants, placed, substeps):
        """Outputs: variants × samples × outputs, and deformations of the springs.

        @param pushes  one input for each variant  @param placed  the effects of each variant
        """
        driven = np.array([self.driven(push, own, substeps) for push, own in zip(pushes, placed)])
        u, w = Chain(variants, len(self.k)).run(driven, STEP, substeps, self.is_ground)
        y = u[:, :, self.outputs].copy()
        for row, own in zip(y, placed):
            for one in at_outputs(own):
                row[:, one.at] = one.effect.act(row[:, one.at], one.values, STEP)
        return y, np.diff(u, axis=2, prepend=0.0), np.diff(w, axis=2, prepend=0.0)

    @staticmethod
    def driven(push, placed, substeps):
        """The input at substeps, linear between samples, after effects on it, which act between samples too."""
        push = np.interp(np.arange((len(push) - 1) * substeps + 1) / substeps, np.arange(len(push)), push)
        for one in (p for p in placed if p.effect.where == INPUT):
            push = one.effect.act(push, one.values, STEP / substeps)
        return push


def draw_system(rng, tier, is_ground):
    count = int(rng.integers(2, 4)) if is_ground else int(rng.integers(1, 4))
    size = 10 ** rng.uniform(0, 6)  # laboratories measure newtons or meganewtons
    masses = size * rng.uniform(1, 2, count)
    frequency = rng.uniform(1.0, 2.0) * (1 + 0.6 * (count - 1))
    k = masses.mean() * (2 * np.pi * frequency) ** 2 * rng.uniform(.8, 1.2, count)
    if is_ground:
        k[0] *= 0.15  # the isolation
    c = 2 * rng.uniform(.02, .05, count) * np.sqrt(k * masses)
    outputs = list(range(count)) if tier != "missing" else [count - 1]
    return System(masses, k, c, outputs, is_ground)


def scales_of(system, push, y, d, v, at, output):
    force = np.abs(system.k * d).max(axis=0)
    return {"F": force[at], "U": np.abs(d).max(axis=0)[at], "V": np.abs(v).max(axis=0)[at],
            "I": np.abs(push).max(), "O": np.abs(y[:, output]).max(), "T": STEP * len(push),
            "P": 0.3 * force[at], "1": 1.0}


def natural(unit, scales):
    above, *below = unit.split("/")
    value = scales[above]
    for word in below:
        value /= scales[word[0]] ** int(word[1:] or 1)
    return value


def draw_effect(effect, system, base, push, rng, size):
    at = int(rng.integers(len(system.outputs) if effect.where == OUTPUT else len(system.k)))
    if effect.where == INPUT or effect.described_by == "all":
        at = 0
    y, d, v = base
    scales = scales_of(system, push, y, d, v, at if effect.where == SPRING else 0, at if effect.where == OUTPUT else 0)
    values = {}
    for name, (unit, low, high, either_sign, is_size) in effect.parameters.items():
        value = rng.uniform(low, high) * natural(unit, scales)
        if either_sign and rng.random() < .5:
            value = -value
        values[name] = value * (size if is_size else 1)
    if "limit" in values and effect.where == OUTPUT:
        values["limit"] = scales["O"] * (1 - size * (1 - values["limit"] / scales["O"]))
    if effect.name == "gain":
        values["factor"] += 1
    return Placed(effect, at, values)


def rival_placements(system, base, push):
    """(effect, number of its spring or output, alternatives), each alternative a list of placements with one size."""
    y, d, v = base
    rivals = []
    for effect in (*chain_effects.spring_effects(), *chain_effects.signal_effects()):
        places = range(len(system.outputs) if effect.where == OUTPUT else len(system.k) if effect.where == SPRING else 1)
        for at in places:
            scales = scales_of(system, push, y, d, v, at if effect.where == SPRING else 0, at if effect.where == OUTPUT else 0)
            rivals.append((effect, at, [_columns(effect, at, scales, share) for share in _shares(effect)]))
    return rivals


def _shares(effect):
    return (.2, .8) if any(not p[4] for p in effect.parameters.values()) else (.3,)


def _columns(effect, at, scales, share):
    middle = {name: (low + share * (high - low)) * natural(unit, scales)
              for name, (unit, low, high, _, _) in effect.parameters.items()}
    sizes = [name for name, p in effect.parameters.items() if p[4]]
    if effect.name == "gain":
        middle["factor"] += 1
    if len(sizes) < 2:
        return [Placed(effect, at, middle)]
    return [Placed(effect, at, middle | {other: 0.0 for other in sizes if other != name}) for name in sizes]


def component(placed, kind):
    if placed.effect.where == INPUT:
        return "input.u"
    if placed.effect.where == OUTPUT:
        return f"output.y{placed.at + 1}"
    if kind == "program":
        return f"port.{placed.at + 1}"
    return "feedback.1" if kind == "linear" else f"spring.{placed.at + 1}"


def make(rng, slot, folder, sources, kind):
    """Writes the case; returns its answer.

    @param kind  mass_spring_damper, linear
    """
    system = draw_system(rng, slot.tier, False)
    if kind == "linear":
        system = System(system.masses[:1], system.k[:1], system.c[:1], [0])
    duration = slot.duration(DURATION)
    t = np.arange(round(duration / STEP)) * STEP
    strength = 0.05 * system.k.mean()
    pushes = [random_sines(rng, t, 0.4, 5, strength * rng.uniform(.7, 1.3)) * swell(t, REST_S, 1.5) for _ in FILES]
    placed, base = _conceal(system, pushes[0], slot, rng)
    recorded = system.respond(pushes, [system.variant(placed)] * len(FILES), [placed] * len(FILES), SUBSTEPS)[0]
    noise = [colour(rng, slot.noise * float(column.std())) for column in base[0].T]
    noisy = [y + np.stack([n.draw(rng, len(t), STEP) for n in noise], axis=1) for y in recorded]
    _write(folder, system, t, pushes, noisy, kind, rng)
    entries, cells = truth_of_chain(system, placed, pushes[0], noise, rng, kind)
    return {"effects": entries, "cells": cells, "nrmse_on_unseen": {"oracle": floor_of(recorded[2], noisy[2])}}


def floor_of(clean, noisy):
    """Error that the noise of the outputs makes: free runs are compared without a filter."""
    return float(np.sqrt(((noisy - clean)**2).sum() / ((noisy - noisy.mean(axis=0))**2).sum()))


def _conceal(system, push, slot, rng):
    y, d, v = (x[0] for x in system.respond([push], [system.variant()], [[]], COARSE))
    library = chain_effects.spring_effects() + chain_effects.signal_effects()
    chosen = effects_for(slot.kind, rng, library, chain_effects.outsiders())
    size = slot.size * (.7 if slot.kind == "pair" else 1)
    return [draw_effect(effect, system, (y, d, v), push, rng, size) for effect in chosen], (y, d, v)


def truth_of_chain(system, placed, push, noise, rng, kind):
    """Entries of the effects, and cells of their places.

    An overflow beside another effect hides nothing of it: the reading is known but for multiples of the span.
    """
    draws = [np.stack([n.draw(rng, len(push), STEP) for n in noise], axis=1) for _ in range(24)]
    whiten = Whitener(draws, STEP, CUTOFF)
    return ([_entry(one, [p for p in placed if p is not one and p.effect.name != "overflow"], system, push, whiten, kind) for one in placed],
            cells_of(STEP * len(push), CUTOFF))


class Neighbourhood:
    """Responses beside those of a system with given effects: by nuisance parameters, and by one more effect."""

    def __init__(self, system, others, push, whiten):
        self.system, self.others, self.push, self.whiten = system, others, push, whiten
        first = system.respond([push], [system.variant(others)], [others], COARSE)
        self.base = first[0][0]
        self.scaled_by = tuple(x[0] for x in first)

    def beside(self, added, changes=()):
        """Whitened changes of the outputs, one for each effect and for each change of parameters."""
        placed = [[*self.others, one] for one in added] + [self.others] * len(changes)
        variants = [self.system.variant(own, **change) for own, change in zip(placed, [{}] * len(added) + list(changes))]
        y = self.system.respond([self.push] * len(placed), variants, placed, COARSE)[0]
        return [self.whiten(row - self.base) for row in y]

    def masses(self):
        """Changes of each mass, which the model states and no fit may move."""
        return {f"mass_error {i + 1}": {"masses": self.system.masses * (1 + .01 * (np.arange(len(self.system.k)) == i))}
                for i in range(len(self.system.k))}

    def tangents(self):
        """Changes of stiffness and damping of each spring."""
        return [{key: np.where(np.arange(len(self.system.k)) == i, factor, 1) * getattr(self.system, key)}
                for key, factor in (("k", 1.005), ("c", 1.05)) for i in range(len(self.system.k))]


def _vector(effect, columns, coefficients):
    """All parameters of a rival whose sizes are those of `columns`, each times its coefficient."""
    vector = []
    for name, (_, _, _, _, is_size) in effect.parameters.items():
        absent = float(effect.name == "gain")
        values = [one.values[name] - absent for one in columns]
        vector.append(float(np.dot(values, coefficients)) if is_size else values[0] + absent)
    return np.array(vector)


def _of_vector(key, vector):
    effect, at = key
    absent = float(effect.name == "gain")
    return Placed(effect, at, {name: float(value) + absent for name, value in zip(effect.parameters, vector)})


def _entry(one, others, system, push, whiten, kind):
    """An effect of an answer."""
    near = Neighbourhood(system, others, push, whiten)
    rivals = {_named(effect, at, kind): (effect, at, columns)
              for effect, at, columns in rival_placements(system, near.scaled_by, push)}
    for name in (one.effect.name, *one.effect.also):
        rivals.pop(f"{name} at {component(one, kind)}", None)
    masses = near.masses() if kind != "linear" else {}
    signals = iter(near.beside([one, *(p for _, _, alternatives in rivals.values() for columns in alternatives for p in columns)],
                               [*masses.values(), *near.tangents()]))
    change = next(signals)
    seen = {name: [[next(signals) for _ in columns] for columns in alternatives]
            for name, (_, _, alternatives) in rivals.items()}
    seen |= {name: [[next(signals)]] for name in masses}

    def refined(starts):
        starts = {name: start for name, start in starts.items() if name in rivals}
        vectors = {name: _vector(rivals[name][0], rivals[name][2][number], coefficients)
                   for name, (number, coefficients) in starts.items()}
        return vectors, lambda asked: near.beside([_of_vector(rivals[name][:2], vector) for name, vector in asked])
    contains = {f"{name} at {component(one, kind)}" for name in one.effect.special_case_of}
    state = {"time": STEP * np.arange(len(push)), "u": None}
    truth = truth_of(change, list(signals), seen, contains, cells_of(STEP * len(push), CUTOFF), state, refined)
    return _described(one, kind) | {"truth": truth}


def _named(effect, at, kind):
    return f"{effect.name} at {component(Placed(effect, at, {}), kind)}"


def _also(effect, kind):
    """Names of the same equation: a transfer function's numerator is a gain."""
    return [*effect.also, *(["coefficient_error"] if kind == "linear" and effect.name == "gain" else [])]


def _described(one, kind):
    effect = one.effect
    absent = float(effect.name == "gain")
    at = component(one, kind)  # a transfer function has one connection, which verdicts do not name
    entry = {"name": effect.name, "component": None if at == "feedback.1" or kind == "linear" and effect.name == "gain" else at, "in_library": effect.in_library,
             "part": effect.part, "channel": component(one, kind), "also": _also(effect, kind),
             "parameters": {name: {"value": float(value)} for name, value in one.values.items()},
             "sizes": [{"name": name, "axis": None, "value": float(one.values[name]), "absent": absent}
                       for name, p in effect.parameters.items() if p[4] and one.values[name]]}
    if effect.form:
        entry["form"] = effect.form
    if effect.described_by == "cogging":
        entry["term_that_describes_it"] = "cogging"
    return entry


def _write(folder, system, t, pushes, noisy, kind, rng):
    names = [f"y{k + 1}" for k in range(len(system.outputs))]
    tables = {file: {"t": t, "u": push} | dict(zip(names, y.T)) for file, push, y in zip(FILES, pushes, noisy)}
    stated_k, stated_c = system.k * (1 + rng.uniform(-.06, .06, len(system.k))), system.c * (1 + rng.uniform(-.2, .2, len(system.k)))
    if kind == "linear":
        m = system.masses[0]
        model = {"kind": "linear", "input": "input.u", "output": "output.y1", "numerator": [1 / m],
                 "denominator": [1.0, stated_c[0] / m, stated_k[0] / m], "fitted": ["denominator.2", "denominator.3"]}
    else:
        model = {"kind": "mass_spring_damper", "masses_kg": system.masses,
                 "fitted": [f"spring.{i + 1}.{name}" for i in range(len(system.k)) for name in ("stiffness", "damping")],
                 "inputs": {"input.u": f"force.{len(system.k)}"},
                 "outputs": {f"output.{name}": f"displacement.{mass + 1}" for name, mass in zip(names, system.outputs)},
                 "spring": [{"between": [i, i + 1], "stiffness_N_per_m": stated_k[i], "damping_N_s_per_m": stated_c[i]}
                            for i in range(len(system.k))]}
    document = {"name": f"{kind}, {len(system.k)} masses",
                "record": [{"file": file, "use": "fit" if i == 0 else "held_out", "quiet_s": [0, REST_S - .1]}
                           for i, file in enumerate(FILES)],
                "channels": {"time": "t [s]", "input": {"u": "u [N]"}, "output": {name: f"{name} [m]" for name in names}},
                "model": model}
    write_case(folder, document, tables)

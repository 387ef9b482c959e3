# SPDX-License-Identifier: Apache-2.0
"""Masses in a chain of springs with effects, many variants at once: Runge-Kutta of fourth order.

    m_i a_i = p_i + f_(i+1) − f_i,   f_i = k d + c d' + effects,   d_i = u_i − u_(i−1),   u_0 = 0 (the ground)

A variant is a dictionary of parameters; those not given are zero, which switches their effect off.
"""
import numpy as np

# Parameters of each spring; a variant gives one value for each of them.
OF_SPRINGS = ("k", "c", "cubic", "quadratic", "stiffening", "onset", "drag", "forward", "backward", "dry", "dry_forward",
              "dry_backward", "breakaway", "stribeck", "presliding", "strength", "yield", "branch", "relaxation", "gap",
              "cogging", "pitch", "slow", "break")
OF_ALL = ("ripple", "ripple_Hz", "ripple_mass", "change", "change_time")  # one value per variant
DEFAULTS = {"onset": 1.0, "presliding": 1.0, "yield": 1.0, "relaxation": 1.0, "stribeck": 1.0, "pitch": 1.0, "break": 1.0}


class Chain:
    """@param variants  dictionaries: "masses" and parameters, each a scalar or one value per spring"""

    def __init__(self, variants, springs):
        self.p = {name: np.array([np.broadcast_to(v.get(name, DEFAULTS.get(name, 0.0)), springs) for v in variants], float)
                  for name in OF_SPRINGS}
        self.p |= {name: np.array([v.get(name, 0.0) for v in variants], float)[:, None] for name in OF_ALL}
        self.m = np.array([v["masses"] for v in variants], float)
        self.on = {name for name, values in self.p.items() if np.any(values)}
        self.mass_numbers = np.arange(springs)[None, :]
        self.shape = self.m.shape
        self.none = np.zeros(self.shape)

    def run(self, push, step, substeps, is_ground):
        """Displacements: variants × samples × masses.

        @param push       variants × substeps: force on the last mass, or acceleration of the ground
        """
        b, n = self.shape
        h, samples = step / substeps, (push.shape[1] - 1) // substeps + 1
        state = {"u": np.zeros((b, n)), "w": np.zeros((b, n)), "z": np.zeros((b, n)), "f": np.zeros((b, n))}
        self.s, self.y, self.d0 = np.zeros((b, n)), np.zeros((b, n)), np.zeros((b, n))
        out, speed = np.zeros((b, samples, n)), np.zeros((b, samples, n))
        spread = -self.m if is_ground else np.eye(n)[-1][None, :] * np.ones((b, 1))
        for k in range(1, samples):
            for j in range(substeps):
                begin = push[:, (k - 1) * substeps + j]
                slope = push[:, (k - 1) * substeps + j + 1] - begin
                loads = [(begin + share * slope)[:, None] * spread for share in (0, .5, 1)]
                state = self._advance(state, loads, h, ((k - 1) + j / substeps) * step)
            out[:, k], speed[:, k] = state["u"], state["w"]
        return out, speed

    def _advance(self, x, loads, h, t):
        k1 = self._rate(x, loads[0], t)
        k2 = self._rate(_plus(x, k1, h / 2), loads[1], t + h / 2)
        k3 = self._rate(_plus(x, k2, h / 2), loads[1], t + h / 2)
        k4 = self._rate(_plus(x, k3, h), loads[2], t + h)
        x = {key: x[key] + h / 6 * (k1[key] + 2 * k2[key] + 2 * k3[key] + k4[key]) for key in x}
        self._remember(between(x["u"]))
        return x

    def _slid(self, d):
        """Presliding state at deformation d, exact from the last substep for a motion in one direction."""
        steps = d - self.d0
        sign = np.sign(steps)
        return sign + (self.s - sign) * np.exp(-np.abs(steps) / self.p["presliding"])

    def _played(self, d):
        half = self.p["gap"] / 2
        return np.minimum(np.maximum(self.y, d - half), d + half)

    def _remember(self, d):
        if self.on & {"dry", "dry_forward", "breakaway"}:
            self.s = self._slid(d)
        if "gap" in self.on:
            self.y = self._played(d)
        self.d0 = d

    def _rate(self, x, load, t):
        d, v = between(x["u"]), between(x["w"])
        force = self._elastic(d, t) + self.p["c"] * v + self._of_velocity(v) + self._dry(d, v) + x["f"]
        rate = {"u": x["w"], "z": self.none, "f": self.none}
        if "strength" in self.on:
            z = x["z"]
            force = force + self.p["strength"] * z
            rate["z"] = v * (1 - z * z * (z * v > 0)) / self.p["yield"]
        if "branch" in self.on:
            rate["f"] = self.p["branch"] * v - x["f"] / self.p["relaxation"]
        if "ripple" in self.on:
            wave = self.p["ripple"] * np.sin(2 * np.pi * self.p["ripple_Hz"] * t)
            load = load + wave * (self.mass_numbers == self.p["ripple_mass"])
        balance = load - force
        balance[:, :-1] += force[:, 1:]
        rate["w"] = balance / self.m
        return rate

    def _elastic(self, d, t):
        p, on = self.p, self.on
        spring = p["k"] * (1 + p["change"] * (t > p["change_time"]) * (self.mass_numbers == 0)) if "change" in on else p["k"]
        force = spring * (self._played(d) if "gap" in on else d)
        if "cubic" in on:
            force = force + p["cubic"] * d**3
        if "quadratic" in on:
            force = force + p["quadratic"] * d * d
        if "stiffening" in on:
            force = force + p["stiffening"] * np.maximum(0, np.abs(d) - p["onset"]) * np.sign(d)
        if "cogging" in on:
            force = force + p["cogging"] * np.sin(2 * np.pi * d / p["pitch"])
        return force

    def _of_velocity(self, v):
        p, on, force = self.p, self.on, 0.0
        if "drag" in on:
            force = p["drag"] * np.abs(v) * v
        if "forward" in on or "backward" in on:
            force = force + np.where(v > 0, p["forward"], p["backward"]) * v
        if "slow" in on:
            force = force + p["slow"] * np.clip(v, -p["break"], p["break"])
        return force

    def _dry(self, d, v):
        p, on, force = self.p, self.on, 0.0
        if not on & {"dry", "dry_forward", "breakaway"}:
            return force
        s = self._slid(d)
        if "dry" in on:
            force = p["dry"] * s
        if "dry_forward" in on:
            force = force + np.where(s > 0, p["dry_forward"], p["dry_backward"]) * s
        if "breakaway" in on:
            force = force + p["breakaway"] * np.exp(-(v / p["stribeck"]) ** 2) * s
        return force


def between(values):
    """Values of masses relative to the one before; the ground is at rest."""
    relative = values.copy()
    relative[:, 1:] -= values[:, :-1]
    return relative


def _plus(x, rate, h):
    return {key: x[key] + h * rate[key] for key in x}

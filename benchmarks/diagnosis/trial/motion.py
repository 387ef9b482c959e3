# SPDX-License-Identifier: Apache-2.0
"""Motion of a specimen, natural scales of its effects, and laws with memory along a motion."""
import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class Motion:
    """Samples × axes; `load` and `force` are the vertical force and the force without any effect."""
    step: float
    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    load: np.ndarray | None
    force: np.ndarray
    scales: dict | None = None  # of another record of the same case; sizes are the same in all records

    @property
    def t(self):
        return self.step * np.arange(len(self.u))

    @property
    def axes(self):
        return self.u.shape[1]

    def scale(self, unit):
        """Natural size of a unit such as "F/V": peaks of force, displacement, velocity, acceleration."""
        peaks = self.scales or self.peaks()
        above, *below = unit.split("/")
        size = peaks[above] if above in peaks else 1.0
        for word in below:
            size /= peaks[word[0]] ** int(word[1:] or 1)
        return size

    def peaks(self):
        return {"F": float(np.abs(self.force).max()), "U": float(np.abs(self.u).max()),
                "V": float(np.abs(self.v).max()), "A": float(np.abs(self.a).max()),
                "N": float(self.load.mean()) if self.load is not None else 1.0, "T": float(self.t[-1])}


def presliding(u, length):
    """Dahl's rule on each axis: ds = (du − s |du|)/length, exact between samples."""
    s = np.zeros_like(u)
    steps = np.diff(u, axis=0)
    keep = np.exp(-np.abs(steps) / length)
    for k, (sign, share) in enumerate(zip(np.sign(steps), keep), 1):
        s[k] = sign + (s[k - 1] - sign) * share
    return s


def play(u, gap):
    """Play operator on each axis: follows u, and moves only beyond ±gap/2."""
    y = np.zeros_like(u)
    for k in range(1, len(u)):
        y[k] = np.minimum(np.maximum(y[k - 1], u[k] - gap / 2), u[k] + gap / 2)
    return y


def relaxed(u, stiffness, time_constant, step):
    """Maxwell branch: dF/dt = k du/dt − F/τ, exact for u linear in each step."""
    keep = np.exp(-step / time_constant)
    gain = stiffness * time_constant / step * (1 - keep)
    force = np.zeros_like(u)
    for k in range(1, len(u)):
        force[k] = keep * force[k - 1] + gain * (u[k] - u[k - 1])
    return force


def bouc_wen(u, yield_displacement, beta=0.5, eta=2.0, pieces=4):
    """z of the isotropic Bouc-Wen rule; midpoint rule on `pieces` of each step. The yield displacement may vary."""
    z = np.zeros_like(u)
    now = np.zeros(u.shape[1])
    yields = np.broadcast_to(yield_displacement, len(u))
    for k, step in enumerate(np.diff(u, axis=0) / pieces, 1):
        for _ in range(pieces):
            middle = now + 0.5 * _slope(now, step, yields[k], beta, eta)
            now = now + _slope(middle, step, yields[k], beta, eta)
        z[k] = now
    return z


def sliding(u, slip):
    """Elastic-plastic rule in the plane: dz = du/slip within |z| < 1, radial return to |z| = 1."""
    z = np.zeros_like(u)
    for k, step in enumerate(np.diff(u, axis=0) / slip, 1):
        tried = z[k - 1] + step
        z[k] = tried / max(1.0, float(np.sqrt(tried @ tried)))
    return z


def _slope(z, du, yield_displacement, beta, eta):
    work = float(z @ du)
    size = float(z @ z)
    if size == 0:
        return du / yield_displacement
    rule = 1 - beta + beta * np.sign(work)
    return (du - z * size ** (eta / 2 - 1) * work * rule) / yield_displacement

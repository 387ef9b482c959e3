# SPDX-License-Identifier: Apache-2.0
"""Recorded ground motions, and the motion of an isolated mass under them."""
import pathlib

import numpy as np

GRAVITY = 9.80665


def files_of(sources):
    """Files of the ground motions; those of the source tree if the others are absent."""
    of_data = sorted((pathlib.Path(sources["data"]) / "ground_motions").glob("*.csv"))
    return of_data or sorted(pathlib.Path(sources["records"]).glob("*.csv"))


def read(file, step):
    """Both horizontal components at the given step [m/s²]."""
    rows = [line.split(",") for line in open(file) if line[:1].isdigit()]
    table = np.array([[float(word) for word in row[:3]] for row in rows])
    at = np.arange(0, table[-1, 0], step)
    return GRAVITY * np.stack([np.interp(at, table[:, 0], table[:, k]) for k in (1, 2)], axis=1)


def strong_part(ground, duration, step):
    """The part of the given length with the most energy."""
    length = min(len(ground), round(duration / step))
    energy = np.cumsum((ground**2).sum(axis=1))
    held = energy[length - 1:] - np.concatenate([[0], energy[:len(ground) - length]])
    begin = int(np.argmax(held))
    return ground[begin:begin + length]


def oscillator(ground, period, damping, step):
    """Relative displacement of a linear oscillator: average acceleration method."""
    frequency = 2 * np.pi / period
    u, v = np.zeros_like(ground), np.zeros(ground.shape[1])
    a = -ground[0]
    whole = 1 + damping * frequency * step + (frequency * step / 2) ** 2
    for k in range(1, len(ground)):
        u_free = u[k - 1] + step * v + step**2 / 4 * a
        v_free = v + step / 2 * a
        a = (-ground[k] - 2 * damping * frequency * v_free - frequency**2 * u_free) / whole
        u[k] = u_free + step**2 / 4 * a
        v = v_free + step / 2 * a
    return u


def platen_motion(rng, files, duration, rest, peak, step):
    """Displacement of an isolated mass: at rest first, and to a given peak. Two axes [m]."""
    ground = strong_part(read(files[rng.integers(len(files))], step), duration - rest, step)
    if rng.random() < 0.5:
        ground = ground[:, ::-1]
    u = oscillator(ground * np.minimum(1, np.arange(len(ground)) * step)[:, None], rng.uniform(1.6, 3.0),
                   rng.uniform(0.1, 0.2), step)
    u *= peak / np.abs(u).max()
    whole = np.zeros((round(duration / step), 2))
    begin = round(rest / step)
    kept = u[:len(whole) - begin]
    whole[begin:begin + len(kept)] = kept
    whole[begin + len(kept):] = kept[-1]
    return whole

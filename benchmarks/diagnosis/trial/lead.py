# SPDX-License-Identifier: Apache-2.0
"""The laboratory's lead plug: strength that falls with temperature, with losses to end plates and shims.

From the equations of docs/theory/lead_rubber.md, whose kernels are inverted here: the flux of an end plate is the half
derivative of the temperature, with the first correction for a disc, and that of the shims its derivative of order 1/3.
"""
import math

import numpy as np

from motion import bouc_wen

RADIUS, HEIGHT, SHIMS = 0.1793, 0.37, 0.12  # [m]
CAPACITY = 1.456e6  # [J/(m³ K)]
CONDUCTIVITY, DIFFUSIVITY = 50.0, 1.41e-5  # of steel [W/(m K)], [m²/s]
PER_KELVIN = 0.0069
SOFTENING = PER_KELVIN / (CAPACITY * math.pi * RADIUS**2 * HEIGHT)  # without losses [1/J]
SHIM_FACTOR = 1.274
ROUNDS = 4  # of temperature and losses, and of force and temperature
FITS = 12  # iterations of effective_softening


def _convolved(kernel, signal):
    size = 1 << (2 * len(signal) - 1).bit_length()
    return np.fft.irfft(np.fft.rfft(kernel, size) * np.fft.rfft(signal, size), size)[:len(signal)]


def _mean_power(exponent, samples, step):
    """Means of t^exponent over the steps before each sample."""
    edges = np.arange(samples + 1) * step
    return np.diff(edges ** (exponent + 1)) / ((exponent + 1) * step)


def temperature(work, step):
    """Rise of the plug's temperature [K] by a history of work [J]."""
    heat = work / (math.pi * RADIUS**2 * CAPACITY * HEIGHT)
    tau = step * DIFFUSIVITY / RADIUS**2
    ends = _mean_power(-1 / 2, len(work), tau) / math.sqrt(math.pi) + 2 / math.pi
    shims = _mean_power(-1 / 3, len(work), tau) * SHIM_FACTOR / (math.gamma(4 / 3) * math.gamma(2 / 3))
    loss = CONDUCTIVITY / RADIUS * (ends + SHIMS / RADIUS * shims) / (CAPACITY * HEIGHT)
    rise = heat
    for _ in range(ROUNDS):
        rise = heat - step * np.cumsum(_convolved(loss, np.diff(rise, prepend=0.0)))
    return rise


def heated(motion, strength, yield_displacement):
    """Force with memory of the heated plug, its share of the strength, and the work that it has taken."""
    factor, steps = np.ones(len(motion.u)), np.diff(motion.u, axis=0)
    for _ in range(2):
        z = bouc_wen(motion.u, yield_displacement * factor)
        for _ in range(ROUNDS):
            force = strength * factor[:, None] * z
            work = np.concatenate([[0.0], np.cumsum(((force[1:] + force[:-1]) / 2 * steps).sum(axis=1))])
            factor = np.exp(-PER_KELVIN * temperature(np.maximum(work, 0), motion.step))
    return force, z, work


def effective_softening(motion, strength, yield_displacement):
    """b of the catalogue's adiabatic_heating, Q exp(−b W) with dW/dt = F·v − W/t_c, that fits the heated plug best.

    The law knows losses only by t_c. So b is not the softening of a plug without losses.
    """
    force, z, work = heated(motion, strength, yield_displacement)
    power = np.diff(work, prepend=0.0)

    def error(values):
        """Of the force; values: factors on softening, on 1/t_c = 1/100 s, on the strength."""
        kept = _convolved(np.exp(-motion.step * np.arange(len(power)) * values[1] / 100), power)
        return (force - values[2] * strength * np.exp(-values[0] * SOFTENING * kept)[:, None] * z).ravel()
    values = np.ones(3)
    for _ in range(FITS):
        now = error(values)
        slopes = np.stack([(error(values + 1e-4 * one) - now) / 1e-4 for one in np.eye(3)], axis=1)
        values = values - np.linalg.lstsq(slopes, now, rcond=None)[0]
    return float(values[0] * SOFTENING)

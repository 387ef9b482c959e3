# SPDX-License-Identifier: Apache-2.0
"""Excitations, sensor noise and filters of the trial's generators."""
import dataclasses
import math

import numpy as np

# Shares of the variance and corner frequencies of sensor noise [Hz]: wide-band, hum and slow drift.
COLOURS = ((0.7, 150.0), (0.2, 8.0), (0.1, 0.8))
ORDER = 4  # of the low-pass filter, applied forwards and backwards


@dataclasses.dataclass(frozen=True)
class Colour:
    """Noise of a sensor: its standard deviation and the share of each colour."""
    deviation: float
    shares: tuple = (0.7, 0.2, 0.1)

    def draw(self, rng, samples, step):
        """A sum of exactly sampled Ornstein–Uhlenbeck processes."""
        total = np.zeros(samples)
        for share, (_, corner) in zip(self.shares, COLOURS):
            keep = math.exp(-2 * math.pi * corner * step)
            kick = rng.standard_normal(samples) * math.sqrt(1 - keep * keep)
            kick[0] = rng.standard_normal()
            total += math.sqrt(share) * _recursion(keep, kick)
        return self.deviation * total


def _recursion(keep, kick):
    """y[k] = keep y[k-1] + kick[k], by a truncated impulse response in the frequency domain."""
    if keep < 1e-4:
        return kick
    size = 1 << (2 * len(kick) - 1).bit_length()
    response = keep ** np.minimum(np.arange(len(kick)), 60 / -math.log(keep))
    return np.fft.irfft(np.fft.rfft(kick, size) * np.fft.rfft(response, size), size)[:len(kick)]


def colour(rng, deviation):
    """A colour with a random mix of shares."""
    shares = np.array([share for share, _ in COLOURS]) * rng.uniform(0.5, 1.5, len(COLOURS))
    return Colour(deviation, tuple(shares / shares.sum()))


def swell(t, rest, rise):
    """0 while at rest, then a smooth rise to 1."""
    phase = np.clip((t - rest) / rise, 0, 1)
    return 0.5 - 0.5 * np.cos(np.pi * phase)


def random_sines(rng, t, low_Hz, high_Hz, rms, count=60):
    frequencies = rng.uniform(low_Hz, high_Hz, count)
    phases = rng.uniform(0, 2 * math.pi, count)
    return rms * math.sqrt(2 / count) * np.sin(2 * np.pi * np.outer(t, frequencies) + phases).sum(axis=1)


def low_passed(signal, cutoff_Hz, step):
    """Zero-phase Butterworth gain along axis 0, with odd reflections at the ends."""
    pad = min(len(signal) - 1, round(8 / (cutoff_Hz * step)))
    head = 2 * signal[:1] - signal[pad:0:-1]
    tail = 2 * signal[-1:] - signal[-2:-pad - 2:-1]
    whole = np.concatenate([head, signal, tail])
    frequencies = np.fft.rfftfreq(len(whole), step)
    gain = 1 / (1 + (frequencies / cutoff_Hz) ** (2 * ORDER))
    gain = gain.reshape(-1, *[1] * (signal.ndim - 1))
    return np.fft.irfft(np.fft.rfft(whole, axis=0) * gain, len(whole), axis=0)[pad:pad + len(signal)]


def rate_of(signal, step):
    """Derivative along axis 0 by central differences of order six, with odd reflections at the ends.

    Two differences of order two would make an acceleration 2 % too small at 10 Hz and 5 ms.
    """
    padded = np.concatenate([2 * signal[:1] - signal[3:0:-1], signal, 2 * signal[-1:] - signal[-2:-5:-1]])

    def apart(k):
        return padded[3 + k:len(signal) + 3 + k] - padded[3 - k:len(signal) + 3 - k]
    return (45 * apart(1) - 9 * apart(2) + apart(3)) / (60 * step)


def delayed(signal, delay, step):
    """signal(t − delay) by cubic interpolation; the delay may vary with time [s]."""
    at = np.arange(len(signal)) - np.broadcast_to(delay, len(signal)) / step
    middle = np.floor(at).astype(int)
    x = at - middle
    weights = (-x * (x - 1) * (x - 2) / 6, (x + 1) * (x - 1) * (x - 2) / 2, -(x + 1) * x * (x - 2) / 2,
               (x + 1) * x * (x - 1) / 6)
    last = len(signal) - 1
    return sum(weight * signal[np.clip(middle + k, 0, last)] for k, weight in zip((-1, 0, 1, 2), weights))


def lagged(signal, time_constant, step):
    """T y' + y = x, exact in each step for x cubic through the two samples before and after it."""
    if time_constant <= 0:
        return signal.copy()
    weights, keep = _weights_of_lag(time_constant / step)
    padded = np.concatenate([2 * signal[:1] - signal[1:2], signal, 2 * signal[-1:] - signal[-2:-1]])
    pushed = sum(weight * padded[k:len(signal) - 1 + k] for k, weight in enumerate(weights))
    out = np.empty_like(signal)
    out[0] = signal[0]
    for k in range(1, len(signal)):
        out[k] = keep * out[k - 1] + pushed[k - 1]
    return out


def _weights_of_lag(steps):
    """Weights of the samples at -2, -1, 0, 1 steps in the change over the step from -1 to 0, and the share that is kept."""
    x, weights = np.polynomial.legendre.leggauss(40)
    keep = math.exp(-1 / steps)
    # Over the exponential itself, which is as smooth for a short lag as for a long one.
    part = keep + (1 - keep) * (x + 1) / 2
    at = steps * np.log(part)
    nodes = np.array([-2.0, -1.0, 0.0, 1.0])
    shares = [np.prod([(at - other) / (node - other) for other in nodes if other != node], axis=0) for node in nodes]
    return [float(weights @ share) * (1 - keep) / 2 for share in shares], keep


def fused(displacement, acceleration, step, crossover_Hz=1.0):
    """Displacement from both sensors: of displacement below the crossover, of acceleration above."""
    pad = round(4 / step)
    u = np.concatenate([2 * displacement[:1] - displacement[pad:0:-1], displacement, 2 * displacement[-1:] - displacement[-2:-pad - 2:-1]])
    a = np.concatenate([-acceleration[pad:0:-1], acceleration, -acceleration[-2:-pad - 2:-1]])
    frequencies = np.fft.rfftfreq(len(u), step).reshape(-1, 1)
    share = 1 / (1 + (frequencies / crossover_Hz) ** (2 * ORDER))
    square = np.maximum((2 * np.pi * frequencies) ** 2, 1e-12)
    both = np.fft.rfft(u, axis=0) * share - np.fft.rfft(a, axis=0) / square * (1 - share)
    return np.fft.irfft(both, len(u), axis=0)[pad:pad + len(displacement)]

# SPDX-License-Identifier: Apache-2.0
"""Whitening by the noise of the generator, and projection on nuisance parameters.

A signal is an array of samples × channels. The noise is known from draws of the generator itself.
"""
import numpy as np

FLOOR = 0.03  # of the largest deviation and of the median density: less noise is not trusted


class Whitener:
    """Divides by the deviation at each time and by the amplitude spectrum of what remains.

    @param draws  signals of noise alone: draws × samples × channels
    @param skip   samples at the start that are not compared
    """

    def __init__(self, draws, step, cutoff_Hz, skip=0):
        draws = np.asarray(draws)[:, skip:]
        self.skip, self.step = skip, step
        self.deviation = _smoothed(np.sqrt((draws**2).mean(axis=0)), round(0.5 / step))
        self.deviation = np.maximum(self.deviation, FLOOR * self.deviation.max(axis=0))
        density = (np.abs(np.fft.rfft(draws / self.deviation, axis=1))**2).mean(axis=0) / draws.shape[1]
        frequencies = np.fft.rfftfreq(draws.shape[1], step)
        self.inside = (frequencies > 0) & (frequencies <= cutoff_Hz)
        density = _smoothed(density, max(3, len(frequencies) // 150))
        floor = FLOOR**2 * np.median(density[self.inside], axis=0)
        self.amplitude = np.sqrt(np.maximum(density, floor))

    def __call__(self, signal):
        """Samples × channels of unit variance, where the signal is noise, within the compared band."""
        spectrum = np.fft.rfft(signal[self.skip:] / self.deviation, axis=0) / self.amplitude
        spectrum[~self.inside] = 0
        return np.fft.irfft(spectrum, len(self.deviation), axis=0)


def _smoothed(values, width):
    """Moving average along axis 0; the ends repeat."""
    width = max(1, min(width, len(values) // 4)) | 1
    half = width // 2
    padded = np.concatenate([np.repeat(values[:1], half, axis=0), values, np.repeat(values[-1:], half, axis=0)])
    sums = np.cumsum(np.concatenate([np.zeros_like(values[:1]), padded]), axis=0)
    return (sums[width:] - sums[:-width]) / width


def basis(columns):
    """Orthonormal columns that span the given ones; dependent ones are left out."""
    if not columns:
        return None
    matrix = np.stack([column.ravel() for column in columns], axis=1)
    scale = np.linalg.norm(matrix, axis=0)
    matrix = matrix[:, scale > 0] / scale[scale > 0]
    left, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
    return left[:, sizes > 1e-9 * sizes[0]] if sizes.size else None


def outside(signal, spanned):
    """The part of a flat signal that a basis does not reproduce."""
    return signal if spanned is None else signal - spanned @ (spanned.T @ signal)

# SPDX-License-Identifier: Apache-2.0
"""Truth of effects on the force along a motion: whitening, nuisances, rivals, cells."""
import numpy as np

from effects import alternatives_of, columns_of, combined, usable, values_of, vector_of
from motion import presliding
from signals import low_passed
from truth import cells_of, truth_of
from whitening import Whitener

CUTOFF = 25.0  # of the comparison [Hz]
RATE = 4  # samples of the comparison per period of the cutoff


def thin(signal, step):
    """Filtered and thinned, as residuals are compared."""
    every = max(1, int(1 / (RATE * CUTOFF * step)))
    filtered = low_passed(signal, CUTOFF, step) if CUTOFF < 0.4 / step else signal
    return filtered[::every], every * step


def whitener_of(draws, step):
    """The whitener of filtered draws, and its step; a whitener stays as it is."""
    if isinstance(draws, tuple):
        return draws
    thinned = [thin(draw, step) for draw in draws]
    return Whitener([draw for draw, _ in thinned], thinned[0][1], CUTOFF), thinned[0][1]


class ForceTruth:
    """Truth of one record.

    @param motion     of the record, with the force without effects
    @param draws      noise of the force, with that which the noise of the motion causes, or the whitener of a record
    @param nuisances  derivatives of the force by the parameters that a fit may move
    @param hysteresis the part of the force that has memory, or None
    @param rivals     effects that may be taken for one; None: all that the motion can show
    """

    def __init__(self, motion, draws, nuisances, hysteresis, rivals=None):
        self.motion = motion
        self.whiten, self.step = whitener_of(draws, motion.step)
        constant = [np.ones_like(motion.u) * (np.arange(motion.axes) == axis) for axis in range(motion.axes)]
        self.nuisances = [self._seen(column) for column in (*nuisances, *constant)]
        self.effects = {effect.name: effect for effect in (usable(motion) if rivals is None else rivals) if effect.in_library}
        self.rivals = {effect.name: [[self._seen(column) for column in columns]
                                     for columns in columns_of(effect, motion, motion.force)]
                       for effect in self.effects.values()}
        if hysteresis is not None:
            self.rivals |= {name: [[self._seen(column) for column in columns]]
                            for name, columns in _of_hysteresis(motion, hysteresis).items()}

    def _seen(self, signal):
        return self.whiten(thin(signal, self.motion.step)[0])

    def of(self, name, change, contains=(), same=()):
        """@param change  of the force by the effect  @param same  names that are as good as the effect's"""
        every = round(self.step / self.motion.step)
        state = {"time": self.motion.t[::every], "u": self.motion.u[::every], "v": self.motion.v[::every]}
        rivals = {rival: columns for rival, columns in self.rivals.items() if rival not in (name, *same)}
        return truth_of(self._seen(change), self.nuisances, rivals, set(contains), force_cells(self.motion), state, self._refined)

    def _refined(self, starts):
        """Start vectors of rivals, and their signals, for fits."""
        vectors = {}
        for name, (number, coefficients) in starts.items():
            if name in self.effects:
                effect = self.effects[name]
                rows = alternatives_of(effect, self.motion)[number]
                vectors[name] = vector_of(effect, combined(effect, rows, coefficients))

        def predict(asked):
            return [self._seen(self._of(name, vector)) for name, vector in asked]
        return vectors, predict

    def _of(self, name, vector):
        effect = self.effects[name]
        return effect.act(self.motion, values_of(effect, vector, self.motion), self.motion.force)


def _of_hysteresis(motion, hysteresis):
    """First-order changes of the part with memory by the terms that modify it."""
    size = np.abs(motion.v).max()
    work = np.cumsum((hysteresis * motion.v).sum(axis=1))[:, None] * motion.step
    reached = np.maximum.accumulate(np.sqrt((motion.u**2).sum(axis=1)))[:, None]
    rivals = {
        "rate_dep_strength": [np.log1p(np.abs(motion.v) / (share * size)) * hysteresis for share in (.02, .2)],
        "adiabatic_heating": [work / work[-1] * hysteresis],
        "scragging": [np.exp(-reached / (.3 * reached[-1])) * motion.u],
        "hysteresis_shape": [presliding(motion.u, share * np.abs(motion.u).max()) for share in (.01, .03, .1, .3)],
        "velocity_dep_sliding": [np.exp(-np.abs(motion.v) / (share * size)) * hysteresis for share in (.05, .3)],
    }
    if motion.load is not None:
        relative = (motion.load / motion.load.mean() - 1)[:, None]
        rivals["axial_load_strength"] = [relative * hysteresis]
        rivals["axial_load_stiffness"] = [relative * motion.u]
        rivals["p_delta"] = [motion.load[:, None] * motion.u]
    return rivals


def force_cells(motion):
    """Cells of the places of effects, as the [map] of the case states them."""
    peaks = motion.peaks()
    return cells_of(float(motion.t[-1]), CUTOFF, 1.05 * peaks["U"], 1.05 * peaks["V"])


def nrmse(measured, computed, step):
    """Root mean square of the filtered error over the standard deviation, without offsets."""
    error, whole = (thin(signal, step)[0] for signal in (measured - computed, measured))
    error, whole = error - error.mean(axis=0), whole - whole.mean(axis=0)
    return float(np.sqrt((error**2).sum() / (whole**2).sum()))

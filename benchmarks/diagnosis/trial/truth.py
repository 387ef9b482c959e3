# SPDX-License-Identifier: Apache-2.0
"""What a perfect observer could see of a concealed effect: information, rivals and place.

All signals are whitened. The noise has unit variance, so ½‖e‖² is an expected gain in log-likelihood [nat].
"""
import numpy as np

from whitening import basis, outside

DETECTABLE = 25  # [nat]
DISTINGUISHABLE = 12  # [nat]
SHARE = 0.8  # of the energy, in the cells of a place
STATE_CELLS = 9  # per side
TIME_CELLS = 100
REFINED = 6  # nearest rivals that are fitted
FAR = 0.3  # of the information: a rival that is farther to first order needs no fit
ITERATIONS = 3
PROBE = 0.02  # relative step of a derivative


def nats(signal):
    return 0.5 * float(signal @ signal)


def truth_of(effect, nuisances, rivals, contains, cells, state, refined=None):
    """The truth of one effect as a dictionary of an answer.

    @param effect     whitened signal with minus without the effect: samples × channels
    @param nuisances  whitened derivatives by the parameters that a fit may move
    @param rivals     name → list of alternatives, each a list of whitened columns with free sizes
    @param contains   names of rivals of which the effect is a special case
    @param refined    fits rivals: starts of rivals → (start vectors, predict), as in fitted_distances
    """
    spanned = basis(nuisances)
    rest = outside(effect.ravel(), spanned)
    information = nats(rest)
    separations = {name: min(_distance(rest, columns, spanned) for columns in alternatives)
                   for name, alternatives in rivals.items() if alternatives}
    if refined is not None:
        vectors, predict = refined(starts_of(rest, rivals, spanned))
        fitted = fitted_distances(rest, spanned, vectors, predict) if vectors else {}
        separations |= {name: min(distance, separations[name]) for name, distance in fitted.items()}
    tie = sorted(name for name, value in separations.items() if value < DISTINGUISHABLE and name not in contains)
    return {
        "energy_nat": nats(effect.ravel()), "information_nat": information,
        "detectable": information >= DETECTABLE,
        "separation_nat": dict(sorted(separations.items(), key=lambda row: row[1])),
        "distinguishable": not tie, "tie": tie,
        "special_case_of": sorted(name for name in contains if separations.get(name, np.inf) < DISTINGUISHABLE),
        "place": place_of(effect, cells, state),
        "place_after_nuisances": place_of(rest.reshape(effect.shape), cells, state),
    }


def _distance(rest, columns, spanned):
    clear = [outside(column.ravel(), spanned) for column in columns]
    return nats(outside(rest, basis(clear)))


def third_octaves(cutoff_Hz):
    edges = [0.0]
    exponent = -7.5
    while 2 ** (exponent / 3) < cutoff_Hz:
        edges.append(2 ** (exponent / 3))
        exponent += 1
    return edges


def cells_of(duration, cutoff_Hz, displacement=1.0, velocity=1.0):
    return {"time_s": duration / TIME_CELLS, "frequency_edges_Hz": third_octaves(cutoff_Hz),
            "state_cells_per_side": STATE_CELLS, "state_displacement_m": displacement,
            "state_velocity_m_per_s": velocity}


def _most(energy):
    """Indices of the fewest cells that hold most of the energy."""
    order = np.argsort(-energy, kind="stable")
    held = np.cumsum(energy[order])
    count = int(np.searchsorted(held, SHARE * held[-1])) + 1 if held.size and held[-1] > 0 else 0
    return sorted(int(cell) for cell in order[:count])


def _shares(energy):
    """Share of the energy in each cell."""
    whole = energy.sum()
    return [float(f"{share:.4g}") for share in (energy / whole if whole > 0 else energy)]


def place_of(signal, cells, state=None):
    """Cells that hold most of a whitened signal's energy.

    @param state  times of the samples [s], and displacement and velocity of each channel, or None
    """
    times = state["time"]
    energy = signal**2
    slot = np.minimum((times / cells["time_s"]).astype(int), 10 * TIME_CELLS)
    in_time = np.bincount(slot, energy.sum(axis=1))
    spectrum = (np.abs(np.fft.rfft(signal, axis=0))**2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(signal), times[1] - times[0])
    edges = cells["frequency_edges_Hz"]
    band = np.searchsorted(edges, frequencies, side="right") - 1
    in_frequency = np.bincount(band, spectrum, len(edges))[:len(edges) - 1]
    place = {"time_cells": _most(in_time), "frequency_cells": _most(in_frequency), "state_cells": None,
             "time_share": _shares(in_time), "frequency_share": _shares(in_frequency), "state_share": None}
    if state.get("u") is not None:
        index = (_cell(state["u"], cells["state_displacement_m"]) * STATE_CELLS
                 + _cell(state["v"], cells["state_velocity_m_per_s"]))
        in_state = np.bincount(index.ravel(), energy.ravel(), STATE_CELLS**2)
        place["state_cells"], place["state_share"] = _most(in_state), _shares(in_state)
    return place


def _cell(values, reach):
    return np.clip(((values / reach + 1) / 2 * STATE_CELLS).astype(int), 0, STATE_CELLS - 1)



def starts_of(rest, rivals, spanned):
    """Rivals worth a fit: name → (number of the best alternative, coefficients of its columns)."""
    ranked = []
    for name, alternatives in rivals.items():
        for k, columns in enumerate(alternatives):
            clear = np.stack([outside(column.ravel(), spanned) for column in columns], axis=1)
            coefficients = np.linalg.lstsq(clear, rest, rcond=None)[0]
            ranked.append((nats(rest - clear @ coefficients), name, k, coefficients))
    best = {}
    for distance, name, k, coefficients in sorted(ranked, key=lambda row: row[0]):
        if distance < FAR * nats(rest) and distance > DISTINGUISHABLE and len(best) < REFINED:
            best.setdefault(name, (k, coefficients))
    return best


def fitted_distances(rest, spanned, starts, predict):
    """Gauss-Newton over all parameters of each rival. @returns name → distance [nat]

    @param starts   name → vector of parameters
    @param predict  list of (name, vector) → whitened signals, for all rivals at once
    """
    best = {name: (np.inf, vector) for name, vector in starts.items()}
    tried = dict(starts)
    for iteration in range(ITERATIONS + 1):
        if not tried:
            break
        asked = []
        for name, vector in tried.items():
            asked += [(name, vector)] + [(name, vector * (1 + PROBE * (np.arange(len(vector)) == k))) for k in range(len(vector))]
        signals = iter([outside(signal.ravel(), spanned) for signal in predict(asked)])
        for name, vector in list(tried.items()):
            here = next(signals)
            slopes = np.stack([(next(signals) - here) / PROBE for _ in vector], axis=1)
            if not (np.isfinite(here).all() and np.isfinite(slopes).all()):
                del tried[name]  # its prediction grows beyond all bounds
                continue
            distance = nats(rest - here)
            if distance < best[name][0]:
                best[name] = (distance, vector)
            step = np.linalg.lstsq(slopes, rest - here, rcond=1e-6)[0]
            tried[name] = vector * (1 + np.clip(step, -0.5, 0.5))
    return {name: distance for name, (distance, _) in best.items()}

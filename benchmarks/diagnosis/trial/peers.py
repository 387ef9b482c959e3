# SPDX-License-Identifier: Apache-2.0
"""Two published selections of terms on the same cases, with a library of the trial's effects on measured signals.

SINDy: sequentially thresholded least squares (Brunton, Proctor & Kutz 2016, PNAS 113, 3932). The threshold is the one
with the smallest error on the second record. FROLS: forward regression by orthogonal least squares, ranked by the error
reduction ratio (Billings, Chen & Korenberg 1989, Int. J. Control 49, 2157), as long as the error on the second record
falls. Terms of the model are always in the regression.
"""
import concurrent.futures
import json
import pathlib
import time

import numpy as np

from judge import NO_VERDICT, judge, right_names
from names import canonical
from peer_problem import problem_of
from whitening import basis, outside

THRESHOLDS = np.geomspace(3e-3, 0.5, 14)  # of a term's rms over that of the residual
LEAST_GAIN = 0.05  # by which terms must reduce the squared error on the second record
LEAST_SHARE = 0.5  # of the residual's energy there, below which terms do not explain it: unknown
MOST = 8  # terms


class Regression:
    """Residuals of a fit by the model's own terms, and library columns without what these reproduce."""

    def __init__(self, problem):
        self.library = problem.library
        self.spanned = [basis(list(block.T)) for block in problem.base]
        self.y = [outside(target, spanned) for target, spanned in zip(problem.targets, self.spanned)]
        self.x = [np.stack([outside(column.signals[k], spanned) for column in problem.library], axis=1)
                  for k, spanned in enumerate(self.spanned)]
        self.size = np.linalg.norm(self.x[0], axis=0)
        self.usable = self.size > 1e-9 * np.linalg.norm(self.y[0])
        self.whole = np.linalg.norm(problem.targets[-1] - problem.targets[-1].mean())

    def solve(self, chosen):
        return np.linalg.lstsq(self.x[0][:, chosen], self.y[0], rcond=1e-8)[0]

    def error(self, chosen, record):
        """Squared error over that without terms."""
        rest = self.y[record] - self.x[record][:, chosen] @ self.solve(chosen) if len(chosen) else self.y[record]
        return float(rest @ rest / (self.y[record] @ self.y[record]))

    def energy(self, chosen):
        """Of each term in the fit, over that of the residual."""
        return np.abs(self.solve(chosen)) * self.size[chosen] / np.linalg.norm(self.y[0])


def stlsq(problem):
    """@returns numbers of the chosen columns"""
    best, least = [], 1.0
    for threshold in THRESHOLDS:
        chosen = np.flatnonzero(problem.usable)
        while len(chosen):
            kept = chosen[problem.energy(chosen) >= threshold]
            if len(kept) == len(chosen):
                break
            chosen = kept
        error = problem.error(chosen, 1)
        if error < least * (1 - 1e-3):
            best, least = list(chosen), error
    return best


def frols(problem):
    """@returns numbers of the chosen columns, the one with the largest error reduction ratio first"""
    chosen, least = [], 1.0
    rest, columns = problem.y[0].copy(), problem.x[0][:, :].copy()
    while len(chosen) < MOST:
        sizes = (columns**2).sum(axis=0)
        ratios = np.where(sizes > 1e-6 * problem.size**2, (columns.T @ rest)**2 / np.maximum(sizes, 1e-300), 0.0)
        ratios[chosen] = 0
        ratios[~problem.usable] = 0
        best = int(np.argmax(ratios))
        error = problem.error([*chosen, best], 1)
        if ratios[best] <= 0 or error > least * (1 - LEAST_GAIN):
            break
        chosen, least = [*chosen, best], error
        one = columns[:, best] / np.linalg.norm(columns[:, best])
        rest = rest - one * (one @ rest)
        columns = columns - np.outer(one, one @ columns)
    return chosen


METHODS = {"sindy": stlsq, "frols": frols}


def names_in(problem):
    """Names and components of the columns that a peer may choose."""
    return sorted({(canonical(column.name), column.component) for column in problem.library}, key=str) if problem else []


def is_in_library(effect, known):
    """Whether a column is named as an effect is, in its component."""
    return any(name in right_names([effect]) and effect.get("component") in (None, component) for name, component in known)


def verdict_of(problem, method):
    """What a peer says of a case, in the form of the tool's verdict; abstains without a problem."""
    if problem is None:
        return NO_VERDICT | {"verdict": "unknown"}
    regression = Regression(problem)
    chosen = method(regression)
    proof = len(regression.y) - 1
    if not len(chosen) or regression.error(chosen, 1) > 1 - LEAST_GAIN:
        return NO_VERDICT | {"verdict": "none", "fit": _fit(regression, [], proof)}
    share = 1 - regression.error(chosen, 1)
    return NO_VERDICT | {"verdict": "missing" if share >= LEAST_SHARE else "unknown",
                         "causes": _causes(regression, chosen), "fit": _fit(regression, chosen, proof)}


def _fit(regression, chosen, proof):
    error = np.sqrt(regression.error(chosen, proof)) * np.linalg.norm(regression.y[proof]) / regression.whole
    return {"unseen": {"nrmse_after": float(error)}}


def _causes(regression, chosen):
    """Names with their sizes, the one with the most energy first."""
    values, energy = regression.solve(chosen), regression.energy(chosen)
    causes = {}
    for k, value, size in sorted(zip(chosen, values, energy), key=lambda row: -row[2]):
        column = regression.library[k]
        cause = causes.setdefault((column.name, column.component), {
            "name": column.name, "channel": column.component, "alternatives": [], "parameters": {}})
        words = [column.name, column.axis, column.parameter] if column.axis else [column.name, column.parameter]
        cause["parameters"].setdefault(".".join(words), {"value": float(value * column.value), "unit": ""})
    return list(causes.values())


def scored(name, out, cases, jobs):
    """Scored rows of a peer; results that exist are kept."""
    with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        return list(pool.map(_one, [(name, str(out), case) for case in cases]))


def _one(task):
    name, out, case = task[0], pathlib.Path(task[1]), task[2]
    kept = out / "peers" / name / f"{case}.json"
    if kept.is_file():
        said = json.loads(kept.read_text())
    else:
        begun = time.process_time()
        problem = problem_of(out / "cases" / case)
        verdict = verdict_of(problem, METHODS[name])
        said = {"verdict": verdict, "cpu_s": time.process_time() - begun, "library": names_in(problem)}
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(said) + "\n")
    answer = json.loads((out / "answers" / f"{case}.json").read_text())
    known = {tuple(column) for column in said["library"]}
    in_library = all(is_in_library(effect, known) for effect in answer["effects"])
    # A peer states no place.
    return judge(said["verdict"], answer) | {"cpu_s": said["cpu_s"], "iou": None, "in_library": in_library}

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the confidence in a name to the share of names that are right, on development seeds and recordings.

    fit_confidence.py --json benchmarks/results/confidence.json [--with EARLIER.json] OUT…

OUT: folders of `rths bench diagnosis`, or of cases with a known answer: right.json (case → names that are right) and
a folder of verdicts beside it. The code has the coefficients (diagnosis/verdict/src/confidence.cpp); a test compares them.
"""
import argparse
import datetime
import json
import math
import pathlib

import numpy as np

from bench import commit, machine
from confidence import FEATURES, features_of
from judge import judge
from names import canonical, terms_of
from results import reliability

RIDGE = 0.02  # on squares of the distances of the coefficients from those that hold without data
WITHOUT_DATA = {"not_held_out": 1.0, "noise_unknown": 1.0}
SWEEPS = 300  # over the coefficients
MOST = 0.99  # a name is never sure


def named_in(out):
    """Names of a folder, each with features and whether it is right; by case."""
    known = out / "right.json"
    if known.is_file():
        return _of_known_cases(out, json.loads(known.read_text()))
    rows = []
    for file in sorted((out / "answers").glob("*.json")):
        answer = json.loads(file.read_text())
        told = out / "verdicts" / file.stem / "verdict.json"
        control = out / "verdicts" / answer["control"] / "verdict.json" if answer.get("control") else None
        if told.is_file() and (control is None or control.is_file()):
            rows.append(judge(json.loads(told.read_text()), answer, json.loads(control.read_text()) if control else None))
    return [one | {"case": row["case"], "set": row["family"], "outcome": row["outcome"]} for row in rows for one in row["named"]]


def _of_known_cases(out, right):
    names = []
    for case, expected in right.items():
        told = out / case / "verdict.json"
        if not told.is_file():
            continue
        verdict = json.loads(told.read_text())
        relation = {name: one for one in verdict["relations"] for name in one["causes"]}
        names += [{"name": cause["name"], "confidence": cause["confidence"], "case": case, "set": "recorded", "outcome": verdict["verdict"],
                   "right": canonical(cause["name"]) in {canonical(name) for name in expected},
                   "features": features_of(cause, relation.get(cause["name"]))} for cause in terms_of(verdict)]
    return names


def logistic(scores):
    return 1 / (1 + np.exp(-scores))


def fitted(names):
    """Intercept, and coefficients ≥ 0 of the features, which lower the confidence: logistic regression with a ridge."""
    x = np.array([[one["features"][key] for key in FEATURES] for one in names])
    y = np.array([float(one["right"]) for one in names])
    expected = np.array([WITHOUT_DATA.get(key, 0.0) for key in FEATURES])
    intercept, slopes = 2.0, expected.copy()
    for _ in range(SWEEPS):  # Newton's method along one coordinate after the other; the problem is convex
        share = logistic(intercept - x @ slopes)
        intercept -= np.sum(share - y) / np.sum(share * (1 - share))
        for k, column in enumerate(x.T):
            share = logistic(intercept - x @ slopes)
            slope = -column @ (share - y) + 2 * RIDGE * (slopes[k] - expected[k])
            bend = column**2 @ (share * (1 - share)) + 2 * RIDGE
            slopes[k] = max(0.0, slopes[k] - slope / bend)
    return float(intercept), slopes


def stated(names, intercept, slopes):
    x = np.array([[one["features"][key] for key in FEATURES] for one in names])
    return np.minimum(MOST, logistic(intercept - x @ slopes))


def cross_checked(names):
    """Confidence of each name by a fit without its case."""
    cases = sorted({one["case"] for one in names})
    group = {case: k % 5 for k, case in enumerate(cases)}
    result = []
    for k in range(5):
        inside = [one for one in names if group[one["case"]] != k]
        outside = [one for one in names if group[one["case"]] == k]
        if outside:
            result += [one | {"confidence": float(value)} for one, value in zip(outside, stated(outside, *fitted(inside)))]
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--with", dest="earlier", type=pathlib.Path, help="result of an earlier fit, whose names count too")
    parser.add_argument("--judge", type=pathlib.Path, help="folder of a trial on which the fit is judged, not made")
    options = parser.parse_args()
    names = [one for folder in options.folders for one in named_in(folder) if one["features"]]
    if options.earlier:
        names += [{"confidence": math.nan} | one for one in json.loads(options.earlier.read_text())["names_used"]]
    intercept, slopes = fitted(names)
    intercept, slopes = round(intercept, 3), np.round(slopes, 3)
    now = [one | {"confidence": float(value)} for one, value in zip(names, stated(names, intercept, slopes))]
    result = {"commit": commit(), "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"), "machine": machine(),
              "cases": len({one["case"] for one in names}), "names": len(names), "right": sum(one["right"] for one in names),
              "intercept": intercept, "coefficients": dict(zip(FEATURES, map(float, slopes))), "most": MOST,
              "reliability": reliability(now), "reliability_cross_checked": reliability(cross_checked(names)),
              "reliability_before": reliability([one for one in names if not math.isnan(one["confidence"])]),
              "names_used": [{key: one[key] for key in ("case", "set", "outcome", "name", "right", "features")} for one in names]}
    if options.judge:
        others = [one for one in named_in(options.judge) if one["features"]]
        result["reliability_judged"] = reliability([one | {"confidence": float(value)} for one, value in zip(others, stated(others, intercept, slopes))])
    for key in (key for key in result if key.startswith("reliability")):
        print(key)
        for row in result[key]:
            if row["names"]:
                print(f"  {row['from']:.2f} to {row['to']:.2f}: stated {row['stated']:.3f}, right {row['right']} of {row['names']}"
                      f" ({row['share']:.3f}, 90 % {row['wilson90'][0]:.3f} to {row['wilson90'][1]:.3f})")
    print(intercept, {key: value for key, value in result["coefficients"].items() if value})
    if options.json:
        options.json.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()

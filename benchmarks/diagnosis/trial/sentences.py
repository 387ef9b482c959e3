# SPDX-License-Identifier: Apache-2.0
"""What must not be in any verdict: impossible shares, contradictory numbers, wrong units, causes of size zero."""
import re

from names import terms_of

NEAR = 1e-6  # of a value
ROUNDED = 6e-3  # of a number with three digits
OF_CHANNEL = {"limit", "step", "offset"}  # parameters of a sensor in the unit of its channel
FORM_OF_LOOP = "hysteresis_shape"  # its sizes act together: each alone means nothing
NUMBER = r"([\d.]+(?:e[-+]?\d+)?)"


def faults_of(verdict, units=None):
    """Texts of the faults of a verdict; an empty list if it has none.

    @param units  role of a channel → unit, or None
    """
    if verdict is None:
        return []
    return [*_shares(verdict), *_numbers(verdict), *_sizes(verdict), *_relations(verdict), *_units(verdict, units or {})]


def units_of(folder):
    """Role of each compared channel → unit, from the tables of predictions in the folder of a verdict."""
    units = {}
    for table in sorted((folder / "predictions").glob("*.csv")):
        with open(table) as lines:
            header = next((line for line in lines if not line.startswith("#")), "")
        units |= dict(re.findall(r"([\w.]+) measured \[([^]]*)\]", header))
    return units


def _shares(verdict):
    said = [float(share) for share in re.findall(NUMBER + " % of (?:the unexplained energy|it)\\b", verdict["sentence"])]
    for share in said:
        if share > 100:
            yield f"the sentence has a share of {share} %"
    known = [cause["explained_fraction"] for cause in verdict["causes"] if cause["explained_fraction"] is not None]
    for share in [*known, verdict["proof"]["explained_fraction"]]:
        if share is not None and not 0 <= share <= 1 + NEAR:
            yield f"a share is {share}"
    by_relation = {name: relation for relation in verdict["relations"] for name in relation["causes"]}
    for relation in verdict["relations"]:
        whole = sum(cause["explained_fraction"] or 0 for cause in verdict["causes"] if by_relation.get(cause["name"]) is relation)
        if whole > 1 + NEAR:
            yield f"the causes of {relation['name']} explain {whole}"


def _is_near(said, value):
    return abs(said - value) <= ROUNDED * max(abs(said), abs(value))


def _numbers(verdict):
    sentence, proof = verdict["sentence"], verdict["proof"]
    for said in re.findall("confidence " + NUMBER, sentence):
        if abs(float(said) - verdict["confidence"]) > 0.0051:
            yield f"confidence is {said} and {verdict['confidence']}"
    unseen = {name: row for name, row in verdict["fit"].items() if row["use"] == "held_out"}
    for name, row in unseen.items():
        found = re.search(re.escape(name) + f"(?: the error)? \\w+ from {NUMBER} % to {NUMBER} %", sentence)
        if found and not (_is_near(float(found[1]), 100 * row["nrmse_before"]) and _is_near(float(found[2]), 100 * row["nrmse_after"])):
            yield f"errors of {name} are {found[0]} and {row['nrmse_before']}, {row['nrmse_after']}"
    if len(unseen) == 1 and not _is_near(next(iter(unseen.values()))["nrmse_after"], proof["nrmse_after"]):
        yield f"the error of the only unseen record is not {proof['nrmse_after']}, that of the proof"
    for said in re.findall("what is left is " + NUMBER + " times", sentence):
        if not abs(float(said) - proof["times_noise"]) <= 0.051 * proof["times_noise"]:
            yield f"what is left is {said} and {proof['times_noise']} times the noise"


def _sizes(verdict):
    for cause in terms_of(verdict):
        sizes = [row for row in cause["parameters"].values() if row.get("absent") is not None and row["value"] is not None]
        if sizes and not cause["is_rule"] and cause["name"] != FORM_OF_LOOP and all(row["ci95"][0] <= row["absent"] <= row["ci95"][1] for row in sizes):
            yield f"{cause['name']} may have no size"
        for row in sizes:
            if row["value"] != row["absent"] and row["value"] in row["ci95"] and row["ci95"][0] < row["ci95"][1]:
                yield f"{cause['name']} is on its bound"


def _relations(verdict):
    named = {name for relation in verdict["relations"] for name in relation["causes"]}
    if not verdict["relations"] and verdict["verdict"] != "failed":
        yield "no relation has a verdict"
    for relation in verdict["relations"]:
        if (relation["verdict"] == "none") != (not relation["causes"] and not relation["verdict"] == "unknown"):
            yield f"{relation['name']} names {relation['causes']} and concludes {relation['verdict']}"
    if verdict["verdict"] == "none" and named:
        yield "nothing is missing, and causes are named"


def _units(verdict, units):
    for cause in verdict["causes"]:
        for name, row in cause["parameters"].items():
            wanted = {unit for role, unit in units.items() if role.startswith(cause["channel"] or "-")}
            if not row["unit"]:
                yield f"{name} has no unit"
            elif cause["part"] == "sensor" and name.rsplit(".", 1)[-1] in OF_CHANNEL and wanted and row["unit"] not in wanted:
                yield f"{name} is in {row['unit']}, its channel in {', '.join(sorted(wanted))}"

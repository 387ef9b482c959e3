# SPDX-License-Identifier: Apache-2.0
"""Counts of scored cases, as the result file and the page state them."""
from chance import Z90, median, quantile, wilson

BINS = (0.0, 0.5, 0.8, 0.95, 1.0)  # of the stated confidence


def rate(rows, is_hit):
    """Hits among rows, with Wilson's interval; null where there is no row."""
    hits, of = sum(1 for row in rows if is_hit(row)), len(rows)
    low, high = wilson(hits, of)
    return {"hits": hits, "of": of, "rate": hits / of if of else None, "wilson95": [low, high] if of else None}


def reliability(named):
    """For each bin of stated confidence: its mean, the share of names that are right, and whether that is within 90 %.

    @param named  names with confidence and whether they are right
    """
    table = []
    for low, high in zip(BINS, BINS[1:]):
        own = [one for one in named if low <= one["confidence"] < high or one["confidence"] == high == 1]
        right, of = sum(one["right"] for one in own), len(own)
        interval, mean = wilson(right, of, Z90), sum(one["confidence"] for one in own) / of if of else None
        table.append({"from": low, "to": high, "names": of, "stated": mean, "right": right, "share": right / of if of else None,
                      "wilson90": list(interval) if of else None, "holds": interval[0] <= mean <= interval[1] if of else None})
    return table


def _verdicts(rows, outcome):
    """Of the verdicts of this outcome: mean of their confidence, and how many are right."""
    own = [row for row in rows if row["outcome"] == outcome and not row["names"]]
    is_there = [row["kind"] != "none" and row["detectable"] for row in own]
    stated = [row["confidence"] for row in own if row.get("confidence") is not None]
    return {"stated": sum(stated) / len(stated) if stated else None} | rate(
        list(zip(own, is_there)), lambda one: one[1] == (outcome == "unknown"))


def _median(values):
    known = [value for value in values if value is not None]
    return median(known) if known else None


def is_right(row):
    """Whether the names of a case are as they should be."""
    if row["kind"] == "none":
        return row["outcome"] == "none"
    if row["kind"] == "outside":
        return row["abstained"]
    if row["kind"] == "pair":
        return row["all_named"]
    return row["right_first"] if row["distinguishable"] else row["right_in_tie"]


def _beside(row, key):
    """A quantity without what is of the recording, where the case has a control."""
    return row.get(key + "_beside", row[key])


def summary(rows):
    """All quantities of a set of scored cases."""
    single = [row for row in rows if row["kind"] == "library"]
    seen = [row for row in single if row["detectable"]]
    pairs = [row for row in rows if row["kind"] == "pair"]
    none = [row for row in rows if row["kind"] == "none"]
    outside = [row for row in rows if row["kind"] == "outside" and row["detectable"]]
    named = [row for row in seen if row["right_first"]]
    found = [size for row in named for size in row.get("sizes", [])]
    over_floor = [row["after_to_oracle"] for row in named if row.get("after_to_oracle") is not None]
    return {
        "cases": len(rows),
        "finished": rate(rows, lambda row: row["outcome"] != "failed"),
        "detectable": sum(1 for row in rows if row.get("detectable")),
        "named_first": rate([row for row in seen if row["distinguishable"]], lambda row: row["right_first"]),
        "named_beside": rate([row for row in seen if row["distinguishable"]], lambda row: _beside(row, "right_first")),
        "right_in_tie": rate(seen, lambda row: row["right_in_tie"]),
        "pairs_both": rate([row for row in pairs if row["detectable"]], lambda row: row["all_named"]),
        "pairs_beside": rate([row for row in pairs if row["detectable"]], lambda row: _beside(row, "all_named")),
        "spurious_per_case": sum(len(row["spurious"]) for row in rows) / len(rows) if rows else None,
        "spurious_beside_per_case": sum(len(_beside(row, "spurious")) for row in rows) / len(rows) if rows else None,
        "none_cases": len(none),
        "false_alarms": rate(none, lambda row: row["outcome"] != "none"),
        "outside_abstained": rate(outside, lambda row: row["abstained"]),
        "form_right": rate(outside, lambda row: row["form_right"]),
        "parameter_error_median": _median([size["error"] for size in found]),
        "coverage95": rate([size for size in found if size["covered"] is not None], lambda size: size["covered"]),
        "after_over_floor_median": _median(over_floor),
        "after_over_floor_90": quantile(over_floor, 0.9) if over_floor else None,
        "iou": {axis: _median([row["iou"][axis] for row in seen if row.get("iou")])
                for axis in ("time", "frequency", "state")},
        "iou_energy": {axis: _median([row["iou_energy"][axis] for row in seen if row.get("iou_energy")])
                       for axis in ("time", "frequency", "state")},
        "seconds_median": _median([row.get("cpu_s") for row in rows]),
        "reliability": reliability([one for row in rows for one in row.get("named", [])]),
        "none_right": _verdicts(rows, "none"), "unknown_right": _verdicts(rows, "unknown"),
        "faulty_verdicts": rate(rows, lambda row: bool(row.get("faults"))),
    }


def by_family_and_tier(rows):
    """{family: {"all": summary, tier: summary}}, and all families together."""
    def by_tier(own):
        return {"all": summary(own)} | {tier: summary([row for row in own if row["tier"] == tier])
                                        for tier in dict.fromkeys(row["tier"] for row in own)}
    families = {family: by_tier([row for row in rows if row["family"] == family])
                for family in dict.fromkeys(row["family"] for row in rows)}
    return families | {"all": by_tier(rows)}


LINES = (("named first", "named_first"), ("named, beside", "named_beside"), ("right in the tie", "right_in_tie"), ("both of a pair", "pairs_both"),
         ("false alarms", "false_alarms"), ("outsiders abstained", "outside_abstained"), ("right form", "form_right"),
         ("intervals that hold", "coverage95"))


def _number(value, digits=2):
    return "–" if value is None else f"{value:.{digits}f}"


def _bin(own):
    return "–" if not own["names"] else f"{own['right']}/{own['names']} ({own['stated']:.2f}{'' if own['holds'] else '!'})"


def text_of(whole):
    """Table for a terminal: a line for each quantity, a column for each family."""
    names = list(whole)
    width = max(12, *(len(name) for name in names)) + 2
    all_of = [whole[name]["all"] for name in names]
    lines = [" " * 24 + "".join(f"{name:>{width}}" for name in names)]

    def line(label, texts):
        lines.append(f"{label:<24}" + "".join(f"{text:>{width}}" for text in texts))
    line("cases", [str(s["cases"]) for s in all_of])
    line("detectable", [str(s["detectable"]) for s in all_of])
    for label, key in LINES:
        line(label, [f"{s[key]['hits']} of {s[key]['of']}" for s in all_of])
    line("spurious per case", [_number(s["spurious_per_case"]) for s in all_of])
    line("spurious, beside", [_number(s["spurious_beside_per_case"]) for s in all_of])
    line("error of sizes", [_number(s["parameter_error_median"], 3) for s in all_of])
    line("after over floor", [_number(s["after_over_floor_median"]) for s in all_of])
    for axis in ("time", "frequency", "state"):
        line(f"overlap, {axis}", [_number(s["iou"][axis]) for s in all_of])
        line("  by energy", [_number(s["iou_energy"][axis]) for s in all_of])
    for k, (low, high) in enumerate(zip(BINS, BINS[1:])):
        line(f"right, {low:g} to {high:g}", [_bin(s["reliability"][k]) for s in all_of])
    line("faulty verdicts", [f"{s['faulty_verdicts']['hits']} of {s['faulty_verdicts']['of']}" for s in all_of])
    line("seconds", [_number(s["seconds_median"], 1) for s in all_of])
    return "\n".join(lines)

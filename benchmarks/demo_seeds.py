"""Runs the demo with ten seeds, in virtual and in real time, and collects what its diagnoses name."""
import json
import statistics

import runs
from results_file import TREE

SEEDS = range(11, 21)
CLOCKS = {"virtual": "virtual", "real": "wall"}
FRICTION = "load_dependent_friction"
HIDDEN = ("adiabatic_heating", FRICTION)  # the simulation omits both
HEATING = ("adiabatic_heating", "lead_heating")
SURE = 0.9


def run(rths, clock, seed, folder):
    """Runs the demo into a folder, unless its verdict is there already."""
    if (folder / "verdict.json").exists():
        return
    runs.run(rths, "srmd_platen_2d.toml", folder, "--force", "--set", f"seed={seed}", clock=CLOCKS[clock])


def is_right(name):
    return name in HIDDEN or name in HEATING


def effects(names):
    """The hidden effects among names: both laws of heating are one."""
    return {"heating" if name in HEATING else name for name in names if is_right(name)}


def of_run(folder, clock, seed):
    """The figures of one run."""
    verdict = json.loads((folder / "verdict.json").read_text())
    report = json.loads((folder / "report.json").read_text())
    causes = [{"name": cause["name"], "confidence": cause["confidence"],
               "alternatives": [other["name"] for other in cause["alternatives"]]} for cause in verdict["causes"]]
    named = effects(cause["name"] for cause in causes)
    tied = effects(name for cause in causes for name in cause["alternatives"])
    budget = {axis["axis"]: {"difference_before": axis["difference_before"], "difference_after": axis["difference_after"],
                             "host": axis["shares"]["host"], "remainder": axis["remainder"],
                             "sum": sum(axis["shares"].values()) + axis["remainder"]}
              for axis in (verdict["budget"] or {"axes": []})["axes"]}
    return {
        "clock": clock, "seed": seed, "conclusive": report["conclusive"], "host_late_max_ms": report["host_late_max_ms"],
        "rows_missing": report["rows_missing"], "causes": causes, "both_named": len(named) == 2,
        "both_named_or_tied": len(named) == 2 or (len(named | tied) == 2 and verdict["next_test"] is not None),
        "friction_without_alternatives": any(cause["name"] == FRICTION and not cause["alternatives"] for cause in causes),
        "without_alternatives": len(named) == 2 and not any(cause["alternatives"] for cause in causes),
        "wrong_and_sure": any(not is_right(cause["name"]) and cause["confidence"] > SURE for cause in causes),
        "error_before": verdict["proof"]["nrmse_before"], "error_after": verdict["proof"]["nrmse_after"],
        "noise_floor": verdict["proof"]["noise_floor"], "budget": budget,
    }


def summary(tests):
    """Counts over some runs, and the scatter of the improved simulation."""
    found = {key: sum(one[key] for one in tests) for key in
             ("both_named", "both_named_or_tied", "friction_without_alternatives", "without_alternatives", "wrong_and_sure",
              "conclusive")}
    found["runs"] = len(tests)
    complete = [one["budget"] for one in tests if len(one["budget"]) == 2]
    found["budgets"] = len(complete)
    found["both_axes_within_3_percent"] = sum(
        all(axis["difference_after"] <= 0.03 for axis in budget.values()) for budget in complete)
    for axis in ("long", "lat"):
        after = [budget[axis]["difference_after"] for budget in complete]
        host = [budget[axis]["host"] for budget in complete]
        found[axis] = {"median": statistics.median(after), "largest": max(after),
                       "host_lowest": min(host), "host_highest": max(host)}
    found["largest_error_of_sum"] = max(abs(axis["sum"] - 1) for budget in complete for axis in budget.values())
    found["largest_lateness_ms"] = max(one["host_late_max_ms"] for one in tests)
    return found


def demo_seeds(rths):
    """All runs. Their folders stay in out/demo_seeds, so an interrupted collection goes on where it stopped."""
    tests = []
    for clock in CLOCKS:
        for seed in SEEDS:
            folder = TREE / "out" / "demo_seeds" / f"{clock}_{seed}"
            run(rths, clock, seed, folder)
            tests.append(of_run(folder, clock, seed))
    return {"all": summary(tests)} | {clock: summary([one for one in tests if one["clock"] == clock]) for clock in CLOCKS} | {
        "each": tests}

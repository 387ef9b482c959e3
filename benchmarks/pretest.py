"""The difference that a pretest predicts beside that of the test, for the demo with the specimen of the test in its
simulation, in virtual time: with different noise of the sensors, and on other machines."""
import json
import math
import statistics
import subprocess

from results_file import TREE, set_options
from runs import report_of

SAME_SPECIMEN = ("--set", "model.specimen.lead_heating.enabled=true")
SEEDS = (1992, 7, *range(11, 17))  # first the example's
AXES = ("long", "lat")
FACTOR = 1.5
# One change of sim/machines/srmd.toml each. The constants of the controller stay those of the nominal machine.
MACHINES = {
    "without_dead_band": ("actuator_long.dead_band=0", "actuator_lat.dead_band=0"),
    "dead_band_0_02": ("actuator_long.dead_band=0.02", "actuator_lat.dead_band=0.02"),
    "valve_11_Hz": ("actuator_long.valve_frequency_Hz=11", "actuator_lat.valve_frequency_Hz=11"),
    "bulk_modulus_1_04_GPa": ("supply.bulk_modulus_Pa=1.04e9",),
    "friction_0_003": ("friction.coefficient=0.003",),
}


def predicted(rths, sets):
    """Mean, lowest and highest difference [%] by axis, and whether the pretest says go."""
    finished = subprocess.run([rths, "pretest", str(TREE / "examples/srmd_platen_2d.toml"), "--json", *sets],
                              capture_output=True, text=True)
    if finished.returncode > 1:  # 1: no-go
        finished.check_returncode()
    found = json.loads(finished.stdout)
    return {"go": found["go"], "loop_machine": found["loop_machine"]} | {
        axis: {"mean": found["axes"][axis]["difference_percent"],
               "lowest": min(found["axes"][axis]["difference_percent_of_runs"]),
               "highest": max(found["axes"][axis]["difference_percent_of_runs"])} for axis in AXES}


def measured(rths, sets):
    """Difference [%] of the test, by axis."""
    report = report_of(rths, "srmd_platen_2d.toml", "--no-diagnosis", "--set", "held_out={}", "--set", "uncompensated={}", *sets)
    return {axis: report["axes"][axis]["numerical_difference_percent"] for axis in AXES}


def row(rths, *sets):
    prediction, test = predicted(rths, (*SAME_SPECIMEN, *sets)), measured(rths, (*SAME_SPECIMEN, *sets))
    return {"predicted": prediction, "measured": test,
            "ratio": {axis: prediction[axis]["mean"] / test[axis] for axis in AXES}}


def summary(rows):
    """Every prediction beside the test with the same seed, and beside all tests."""
    found = {"values": len(rows) * len(AXES), "seeds": len(rows)}
    paired = [one["ratio"][axis] for one in rows for axis in AXES]
    crossed = [mine["predicted"][axis]["mean"] / other["measured"][axis] for mine in rows for other in rows for axis in AXES]
    for name, ratios in (("paired", paired), ("crossed", crossed)):
        found[name] = {"of": len(ratios), "within": sum(1 / FACTOR <= ratio <= FACTOR for ratio in ratios),
                       "lowest": min(ratios), "highest": max(ratios)}
    for axis in AXES:
        tests = [one["measured"][axis] for one in rows]
        means = [one["predicted"][axis]["mean"] for one in rows]
        within = sum(one["predicted"][axis]["lowest"] <= one["measured"][axis] <= one["predicted"][axis]["highest"]
                     for one in rows)
        found[axis] = {"measured_mean": statistics.mean(tests), "measured_lowest": min(tests),
                       "measured_highest": max(tests), "measured_scatter": statistics.stdev(map(math.log, tests)),
                       "predicted_mean": statistics.mean(means), "predicted_lowest": min(means),
                       "predicted_highest": max(means), "tests_in_predicted_range": within}
    return found


def predictions(rths):
    rows = {seed: row(rths, "--set", f"seed={seed}") for seed in SEEDS}
    machines = {name: row(rths, *set_options(f"node.srmd.changes.{change}" for change in changes))
                for name, changes in MACHINES.items()}
    return {"factor": FACTOR, "noise": summary(list(rows.values())),
            "seeds": {str(seed): one for seed, one in rows.items()}, "machines": machines}

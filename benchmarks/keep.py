#!/usr/bin/env python3
"""Writes result files that `./lab bench --full` does not make, to benchmarks/results or --into FOLDER.

usage: keep.py demo REPORT                 report.json of `./lab demo --headless --solver numerical`
       keep.py examples RTHS               runs examples in virtual time and bearing loops with the command RTHS
       keep.py budget RTHS                 mismatch budgets of examples in virtual time
       keep.py demo_seeds RTHS             the demo with ten seeds, in virtual and in real time; takes an hour
       keep.py least_squares FITS          what rths_fit_bench has printed
       keep.py opensees_runs RTHS          runs OpenSees with RTHS, and alone with RTHS_OPENSEES_PYTHON
       keep.py card RTHS                   hops per second of cards in virtual time
       keep.py srmd RESULTS                what `rths bench srmd --json RESULTS` has written
       keep.py mutants RESULT              what tests/replicated/mutants.py --json RESULT has written
       keep.py substeps RESULT             what rths_substeps_bench has printed
       keep.py solver RESULT               what `rths bench solver --json` has printed; solver_opensees: beside OpenSees
       keep.py traps RESULT                what rths_trap_bench has printed
       keep.py pretest RTHS                the prediction of a pretest beside the test, in virtual time
       keep.py adaptive RTHS               the adaptive inverse and ATS on drawn machines, in virtual time
       keep.py plants RTHS                 large plants: reduced beside full, targets of 10 and 1 ms
       keep.py force RTHS                  identification of empty tables
       keep.py kills TESTS                 TESTS: the file that a test program wrote with
       keep.py deaths TESTS                  --gtest_output=json:TESTS
       keep.py real_recordings TESTS
       keep.py opensees_comparison TESTS

Standard library only. tests/style/figures.py compares the pages with these files.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import adaptive
import demo_seeds
import opensees_runs
import plants
import pretest
import runs
from results_file import RESULTS, commit, machine, set_options, stamp, write

RUN_KEYS = ("name", "clock", "processes", "duration_s", "integration_step_s", "control_rate_hz", "overruns",
            "slow_downs", "slow_downs_excused", "host_late_max_ms", "steps_excused", "conclusive",
            "predict_ms_mean", "correct_ms_mean", "axes")
COLD = {  # no heating, friction independent of velocity
    "lprb": ["lead_heating.enabled=false"],
    "eqsb": ["friction_heating.enabled=false", "velocity_dep_sliding.enabled=false"],
    "tpfb": ["triple_pendulum.heat_share=0"] + [f"triple_pendulum.low_velocity_reduction_{i}=0" for i in (1, 2, 3)],
}
AXIAL_LISTED = {"LeadRubberXVerticalStiffness", "LeadRubberXFourEffects", "LeadRubberXAllEffects",
                "LeadRubberXAllEffectsAndCooling", "LeadRubberXBeyondBuckling"}
# On the machine with six degrees of freedom: ATS, and feed-forward with a gain of 0.4 at the valves.
PAPERS_CONTROLLER = ('node.xpc={adapter="simulink_like", diagram="hybrid_controller", '
                     'tune={feed_forward.velocity_gain_s=0, valve_feed_forward.value=4}}')
PAPER_UNCOMPENSATED = "uncompensated.xpc={ats.enabled=0, valve_feed_forward.value=0}"
FAR_RESPONSE = "conclusive.response=0.6"  # ATS drives the lightly damped modes
SAME_SPECIMEN = ("--no-diagnosis", "--set", "model.specimen.lead_heating.enabled=true")  # in test and simulation
NO_DEAD_BAND = ("node.srmd.changes.actuator_long.dead_band=0", "node.srmd.changes.actuator_lat.dead_band=0")
SRMD_GOALS = {"delay_ms": 0.5, "delay_windows_largest_ms": 1.5, "nrms_percent": 0.2}  # of an axis, magnitudes
FLOOR_GOAL = 5  # of the floor spectra [%]
LOOPS = {"lprb": (0.210, 0.3), "eqsb": (0.152, 0.3), "tpfb": (0.584, 0.1)}  # amplitude [m], frequency [Hz]


def lowest_and_highest(floors, ratio, band):
    values = [floor[ratio][band] for floor in floors.values() if floor.get(ratio)]
    return {"lowest": min(values), "highest": max(values)} if values else None


def of_diagnosis(verdict):
    """The figures of a verdict that pages quote."""
    def half_width(interval):
        return (interval[1] - interval[0]) / 2
    causes = [{"name": cause["name"], "part": cause["part"], "confidence": cause["confidence"],
               "parameters": {name: values | {"half_width": half_width(values["ci95"])}
                              for name, values in cause["parameters"].items()},
               "alternatives": [other["name"] for other in cause["alternatives"]]} for cause in verdict["causes"]]
    explained = re.search(r"explains (\d+) %", verdict["sentence"])
    return {"verdict": verdict["verdict"], "sentence": verdict["sentence"], "confidence": verdict["confidence"],
            "explained_percent": int(explained[1]) if explained else None,
            "part": verdict["where"]["part"], "causes": causes, "fit": verdict["fit"]}


def of_run(report):
    """The figures of a run's report.json that pages quote; stops if the host was too busy for a result."""
    if not report["conclusive"]:
        raise SystemExit(f"{report['name']}: the test is not conclusive; repeat it on a quiet machine if the host "
                         "was late:\n" + "\n".join(broken["text"] for broken in report["broken"]))
    result = {key: report[key] for key in RUN_KEYS}
    result["floors_6_to_11_Hz"] = {ratio: lowest_and_highest(report["floors"], ratio, "6_to_11_Hz")
                                   for ratio in ("hybrid_over_numerical", "hybrid_over_improved")}
    if report.get("diagnosis"):
        result["diagnosis"] = of_diagnosis(report["diagnosis"])
    return result


def third_cycle(rths, bearing, changes):
    """Peak force and strength [kN] of the third full cycle of a bearing's loop."""
    amplitude, frequency = LOOPS[bearing]
    loop = subprocess.run([rths, "loop", bearing, "--amplitude-m", str(amplitude), "--frequency-Hz", str(frequency),
                           *set_options(changes)], capture_output=True, text=True, check=True)
    cycle, peak, strength, *_ = loop.stdout.split("\n")[4].split()
    if cycle != "3":
        raise SystemExit(f"rths loop {bearing}: expected cycle 3 in the fifth line, found:\n{loop.stdout}")
    return {"peak_kN": float(peak), "strength_kN": float(strength)}


def examples(rths):
    """Results of the examples in virtual time, which are the same on every run."""
    def run(example, *options):
        return of_run(runs.report_of(rths, example, *options))
    return {
        "runs": {
            "lprb": run("srmd_lprb_2d.toml"),
            "lprb_full_model": run("srmd_lprb_2d.toml", "--no-diagnosis",
                                   "--set", "model.specimen.lead_heating.enabled=true",
                                   "--set", "model.machine.load_dependent_friction.enabled=true"),
            "demo": run("srmd_platen_2d.toml"),
            "platen": run("srmd_platen_2d.toml", *SAME_SPECIMEN),
            "platen_seed_7": run("srmd_platen_2d.toml", *SAME_SPECIMEN, "--set", "seed=7"),
            "platen_without_dead_band": run("srmd_platen_2d.toml", *SAME_SPECIMEN, *set_options(NO_DEAD_BAND)),
            "platen_ats": run("srmd_platen_2d.toml", *SAME_SPECIMEN, "--set", PAPERS_CONTROLLER, "--set", PAPER_UNCOMPENSATED,
                              "--set", FAR_RESPONSE),
            "eqsb": run("srmd_eqsb_2d.toml", "--no-diagnosis"),
            "tpfb": run("srmd_tpfb_2d.toml", "--no-diagnosis"),
            "mismatch_tracking": run("mismatch_tracking_2d.toml"),
            "mismatch_tracking_slow": run("mismatch_tracking_2d.toml", "--no-diagnosis", "--set", "rate=2"),
            "mismatch_coupling": run("mismatch_coupling.toml"),
        },
        "loops": {bearing: {"all_effects": third_cycle(rths, bearing, []),
                            "cold": third_cycle(rths, bearing, COLD[bearing])} for bearing in LOOPS},
    }


def srmd(results):
    """The results with the share of draws that meets each goal. An unstable test meets none."""
    for name, family in results["family"].items():
        record, controller = name.rsplit(", ", 1)
        tests = [test for row in results["rows"] if row["member"] > 0 and row["record"] == record
                 for test in row["tests"] if test["controller"] == controller]
        stable = [test for test in tests if test["stable"]]
        met = sum(test["floor_error_percent"] <= FLOOR_GOAL for test in stable)
        family["floor_error_percent"]["met_percent"] = 100 * met / len(tests)
        for place, axis in enumerate(stable[0]["axes"]):
            for figure, goal in SRMD_GOALS.items():
                met = sum(abs(test["axes"][place][figure]) <= goal for test in stable)
                family[f"{axis['axis']}.{figure}"]["met_percent"] = 100 * met / len(tests)
    return results


def budget(rths):
    """Mismatch budgets of three examples in virtual time, by axis."""
    def run(example):
        with tempfile.TemporaryDirectory() as folder:
            runs.run(rths, example, folder)
            found = json.loads((pathlib.Path(folder) / "verdict.json").read_text())["budget"]
            return {axis.pop("axis"): axis for axis in found["axes"]} | {"replay_nrms": found["replay_nrms"]}
    return {"demo": run("srmd_platen_2d.toml"), "lprb": run("srmd_lprb_2d.toml"), "tracking": run("mismatch_tracking_2d.toml")}


def tests_of(file):
    """Tests of a --gtest_output=json file with their recorded properties; stops if one failed or was skipped."""
    known = {"name", "file", "line", "status", "result", "timestamp", "time", "classname", "value_param"}
    for suite in read(file)["testsuites"]:
        for test in suite["testsuite"]:
            name = f"{suite['name']}.{test['name']}"
            if "failures" in test or test["result"] != "COMPLETED":
                raise SystemExit(f"{file}: {name} is {test['result']}"
                                 f"{', failed' if 'failures' in test else ''}; expected a passed test")
            yield name, {key: number(value) for key, value in test.items() if key not in known}


def number(text):
    """A property as a number, if it is one. GoogleTest's JSON takes each byte of UTF-8 for a character."""
    if re.fullmatch(r"-?\d+", str(text)):
        return int(text)
    try:
        return float(text)
    except ValueError:
        return text.encode("latin-1", "ignore").decode() if isinstance(text, str) else text


def kills(file):
    """Kills of writers, summed over the lengths of a group; the slowest repair of the three."""
    rows = {name.rsplit("/", 1)[1]: values for name, values in tests_of(file) if "kills" in values}
    sums = {key: sum(row[key] for row in rows.values()) for key in ("kills", "stopped", "reads", "torn", "hung", "lost")}
    return sums | {"repair_p99_ms": max(row["repair_p99_ms"] for row in rows.values()), "by_length": rows}


def deaths(file):
    """Deaths and stops of the processes of a run, summed over the roles; the slowest rests."""
    rows = {name.rsplit("/", 1)[1]: values for name, values in tests_of(file) if "rest_after_stop_s" in values}
    slowest = ("rest_after_kill_s", "rest_after_stop_s")
    sums = {key: sum(row[key] for row in rows.values()) for key in next(iter(rows.values())) if key not in slowest}
    return sums | {key: max(row[key] for row in rows.values()) for key in slowest} | {"by_role": rows}


def real_recordings(file):
    """Verdicts on recordings; `emps_without_asymmetric_viscous`: with these terms barred, named by the first."""
    rows = {}
    for _, values in tests_of(file):
        if "recording" in values:
            without = values.pop("without")
            rows[values["recording"] + (f"_without_{without}" if without else "")] = values
    return {"recordings": rows}


def opensees_comparison(file):
    """NRMSE [%] of each row and path; the largest of axial force where the page lists no other."""
    rows = {name.rsplit("/", 1)[-1].split(".")[0]: values for name, values in tests_of(file) if values}
    largest = max(value for name, values in rows.items() if name not in AXIAL_LISTED
                  for key, value in values.items() if key.endswith("_axial_percent"))
    return {"largest_axial_percent": largest, "rows": rows}


def read(file):
    return json.loads(pathlib.Path(file).read_text())


def bench(name):
    """`rths bench NAME`; its `result` says whether it met its goals."""
    def run(rths):
        ran = subprocess.run([rths, "bench", name, "--json"], capture_output=True, text=True)
        try:
            return json.loads(ran.stdout)
        except json.JSONDecodeError:
            sys.exit(ran.stderr or f"{rths} bench {name} printed no result")
    return run


def main():
    makers = {"demo": lambda file: of_run(read(file)), "srmd": lambda file: srmd(read(file)),
              "least_squares": read, "mutants": read, "solver": read, "solver_opensees": read, "substeps": read, "traps": read,
              "card": bench("card"), "force": bench("force"), "vertical": bench("vertical"),
              "adaptive": adaptive.adaptive, "budget": budget, "demo_seeds": demo_seeds.demo_seeds, "examples": examples,
              "plants": plants.plants, "pretest": pretest.predictions,
              "opensees_runs": lambda rths: opensees_runs.differences(rths, os.environ["RTHS_OPENSEES_PYTHON"]),
              "kills": kills, "deaths": deaths, "real_recordings": real_recordings,
              "opensees_comparison": opensees_comparison}
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("name", choices=makers)
    arguments.add_argument("file", help="the file or command to read from")
    arguments.add_argument("--into", type=pathlib.Path, default=RESULTS)
    options = arguments.parse_args()
    result = makers[options.name](options.file)
    write(options.into / f"{options.name}.json", stamp(commit()) | {"machine": machine()} | result)


if __name__ == "__main__":
    sys.exit(main())

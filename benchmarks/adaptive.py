"""Runs the demo's test with its adaptive inverse and with ATS on drawn machines, in virtual time."""
import random
import statistics

from runs import report_of

DRAWS = 5  # beside the nominal machine
EXAMPLES = {"adaptive": "srmd_lprb_2d.toml", "ats": "srmd_lprb_2d_ats.toml"}
# The simulation with the same specimen and machine: what differs is the test.
SAME = ("--set", "model.specimen.lead_heating.enabled=true", "--set", "model.machine.load_dependent_friction.enabled=true")
FIGURES = ("delay_compensated_ms", "delay_in_windows_median_ms", "delay_in_windows_max_ms", "nrms_percent",
           "peak_error_percent", "numerical_difference_percent")


def machine(draw):
    """Hydraulics of both axes: bulk modulus ±20 %, valve ±15 %, dead band 0.5 to 2 %."""
    if draw == 0:
        return []
    drawn = random.Random(draw)
    values = {"bulk_modulus_Pa": 1.4e9 * drawn.uniform(0.8, 1.2), "valve_frequency_Hz": 12 * drawn.uniform(0.85, 1.15),
              "dead_band": drawn.uniform(0.005, 0.02)}
    return [part for key, value in values.items() for part in ("--set", f"machine.{key}=[{value}, {value}]")]


def run(rths, example, draw):
    """Figures by axis, or None if the safety layer ended the test."""
    report = report_of(rths, example, "--no-diagnosis", *SAME, *machine(draw), may_end_early=True)
    if report["ending"]:
        if "safety trip" not in report["ending"]:
            raise RuntimeError(f"{example}, machine {draw}: {report['ending']}")
        return None
    return {axis: {key: report["axes"][axis][key] for key in FIGURES} for axis in ("long", "lat")}


def adaptive(rths):
    """Per controller: number of tests that the safety layer ended; per axis, figures of the nominal machine, and median and
    largest magnitude over the machines whose test was completed."""
    found = {}
    for name, example in EXAMPLES.items():
        runs = [run(rths, example, draw) for draw in range(DRAWS + 1)]
        if runs[0] is None:
            raise RuntimeError(f"{example}: the safety layer ended the test of the nominal machine")
        tripped = runs.count(None)
        runs = [one for one in runs if one is not None]
        found[name] = {"tripped": tripped} | {axis: {"nominal": runs[0][axis]} | {
            label: {key: of([abs(one[axis][key]) for one in runs]) for key in FIGURES}
            for label, of in (("median", statistics.median), ("largest", max))} for axis in ("long", "lat")}
    return {"draws": DRAWS} | found

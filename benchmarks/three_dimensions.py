#!/usr/bin/env python3
"""Runs the example in three dimensions with both vertical controllers, in virtual time; rates vertical force and response."""
import concurrent.futures
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy

import results_file

DURATION = 20  # [s]
DRAWS, FEW_DRAWS, JOBS = 200, 20, 2  # members of the machine's family beside the nominal one; runs at one time
SEGMENT, LOWEST, HIGHEST = 2.0, 1.0, 15.0  # of the coherence [s], [Hz], [Hz]
FIRST = 3.0  # [s]: rest and first second of the test are left out
NOISE = 30e3  # of the measured vertical force, white [N]: sim/machines/srmd.toml
COMMAND, MEASURED = "monitor.xpc.vertical_load.out", "monitor.xpc.vertical_measured.out"
UNCORRECTED = {"node.xpc.blocks.vertical_lag.enabled": 0}
SLIDERS = ("eqsb", "tpfb")
CASES = {"lead": {}, "lead_model": {"node.opf.vertical_feedback": "model"},
         "lead_uncorrected": UNCORRECTED,
         "cascade": {"node.xpc.blocks.vertical.law": "cascade"} | UNCORRECTED,
         "cascade_model": {"node.opf.vertical_feedback": "model", "node.xpc.blocks.vertical.law": "cascade"},
         "cascade_slow": {"node.opf.vertical_feedback": "model", "node.xpc.blocks.vertical.law": "cascade", "rate": 10}}


def spectra(command, measured, step):
    """Least coherence of 1 to 15 Hz and of 1 to 12 Hz, by Welch's method, and that of 1 to 15 Hz if only noise were added."""
    length = round(SEGMENT / step)
    window, cross, power, response, noise = numpy.hanning(length), 0, 0, 0, 0
    for begin in range(0, len(command) - length, length // 2):
        c, f = (numpy.fft.rfft(window * (x[begin:begin + length] - command.mean())) for x in (command, measured))
        cross, power, response = cross + c.conj() * f, power + abs(c) ** 2, response + abs(f) ** 2
        noise += NOISE ** 2 * (window ** 2).sum()
    frequency, coherence = numpy.fft.rfftfreq(length, step), abs(cross) ** 2 / (power * response)
    return [float(values[(frequency >= LOWEST) & (frequency <= high)].min())
            for values, high in ((coherence, HIGHEST), (coherence, 12), (power / (power + noise), HIGHEST))]


def figures(table, rate):
    """Delay, RMS error over peak to peak and coherence of the measured force, in model time."""
    with open(table) as file:
        names = [name.split(" ")[0] for name in next(csv.reader(file))]
    values = numpy.loadtxt(table, delimiter=",", skiprows=1)[::rate]
    time = values[:, 0] / rate
    used = (time > FIRST) & (time < DURATION + 2)
    command, measured = (values[used, names.index(name)] for name in (COMMAND, MEASURED))
    late = numpy.arange(-20, 81)
    rms = [numpy.sqrt(numpy.mean((measured[80:-20] - command[80 - k:len(command) - 20 - k]) ** 2)) for k in late]
    best = int(numpy.argmin(rms))
    shift = 0.0
    if 0 < best < len(rms) - 1:
        a, b, c = (rms[best + i] ** 2 for i in (-1, 0, 1))
        shift = (a - c) / (2 * (a - 2 * b + c))
    wide, to_12, of_noise = spectra(command, measured, 1e-3)
    span = float(numpy.ptp(command))
    return {"delay_ms": float(late[best] + shift), "rms_percent": float(100 * rms[20] / span), "span_MN": span / 1e6,
            "coherence_to_15_Hz": wide, "coherence_to_12_Hz": to_12, "coherence_of_noise_to_15_Hz": of_noise}


def run(rths, changes, bearing="lprb"):
    with tempfile.TemporaryDirectory() as folder:
        sets = {"duration_s": DURATION, "uncompensated": "{}"} | changes
        finished = subprocess.run(
            [rths, "run", str(results_file.TREE / "examples" / f"srmd_{bearing}_3d.toml"), "--clock", "virtual", "--no-diagnosis",
             "--out", folder, *(part for key, value in sets.items() for part in ("--set", f"{key}={value}"))],
            capture_output=True, text=True)
        if finished.returncode > 1:
            return {"ended": finished.stderr.strip().splitlines()[-1]}
        table = pathlib.Path(folder) / "vertical.csv"
        subprocess.run([rths, "export", folder, "--signals", COMMAND, MEASURED, "--out", str(table)], check=True,
                       stdout=subprocess.DEVNULL)
        axes = json.loads((pathlib.Path(folder) / "report.json").read_text())["axes"]
        return figures(table, int(changes.get("rate", 1))) | {
            "response_percent": {name: axis["numerical_difference_percent"] for name, axis in axes.items()}}


if __name__ == "__main__":
    commit = results_file.commit()
    cases = {name: run(sys.argv[1], changes) for name, changes in CASES.items()}
    cases |= {bearing: run(sys.argv[1], {}, bearing) for bearing in SLIDERS}
    for name, changes, bearing, draws in (("drawn", {}, "lprb", DRAWS), ("drawn_uncorrected", UNCORRECTED, "lprb", FEW_DRAWS),
                                          *((f"drawn_{bearing}", {}, bearing, FEW_DRAWS) for bearing in SLIDERS)):
        members = [changes | {"node.srmd.family_member": draw} for draw in range(1, draws + 1)]
        with concurrent.futures.ThreadPoolExecutor(JOBS) as jobs:
            drawn = list(jobs.map(lambda member: run(sys.argv[1], member, bearing), members))
        ran = [one for one in drawn if "ended" not in one]
        cases[name] = {"tests": draws, "completed": len(ran)} | {
            key: of((abs(one[key]) for one in ran), default=None) for key, of in
            (("delay_ms", max), ("rms_percent", max), ("coherence_to_15_Hz", min), ("coherence_to_12_Hz", min),
             ("coherence_of_noise_to_15_Hz", min))}
    results_file.write(results_file.RESULTS / "three_dimensions.json",
                       results_file.stamp(commit) | {"machine": results_file.machine(), "duration_s": DURATION} | cases)

#!/usr/bin/env python3
"""Which causes and frequencies the tracking error of the demo's controller consists of: one strong run, causes removed in turn.

usage: tracking_split.py RTHS [--seconds S]      the command rths; writes benchmarks/results/tracking_split.json

Virtual time, nominal machine with six degrees of freedom, Imperial Valley. Standard library only.
"""
import argparse
import json
import math
import pathlib
import re
import subprocess
import tempfile

import keep
from results_file import RESULTS, TREE, commit, machine, set_options, stamp, write

EXAMPLES = TREE / "examples"
SILENT = ", ".join(f"{key}=0" for key in ("displacement_noise_m", "rotation_noise_rad", "force_noise_N",
                                          "vertical_force_noise_N", "moment_noise_N_m", "acceleration_noise_m_per_s2"))
CHANGES = "node.srmd.changes.%s"


def pressure_gain(gain):
    return [CHANGES % f"actuator_{axis}.pressure_gain={gain}" for axis in ("long", "lat")]


RUNS = {  # names on the page, and what differs from the demo
    "as it is": [],
    "without sensor noise": [CHANGES % f"transducers={{{SILENT}}}"],
    "without friction of the machine": [CHANGES % "friction={coulomb_N=[0, 0], viscous_N_s_per_m=[0, 0], coefficient=0}"],
    "without dead band": list(keep.NO_DEAD_BAND),
    "no pressure feedback at the valves": pressure_gain(0),
    "twice the pressure feedback": pressure_gain(0.1),
    "memory of the inverse 10 s": ["node.xpc.blocks.inverse.forgetting_s=10"],
    "command without average and notch": ["node.xpc.blocks.inverse.average_s=0",
                                          "node.xpc.blocks.inverse.oil_column_Hz=[0, 0]",
                                          "node.xpc.blocks.inverse.smoothing_s=0.004"],
    "without notch": ["node.xpc.blocks.inverse.oil_column_Hz=[0, 0]"],
}


def experiment(folder):
    """The demo under Imperial Valley, alone: with the specimen of the test in the simulation."""
    text = (EXAMPLES / "srmd_platen_2d.toml").read_text()
    text = re.sub(r"\n\[held_out\]\n[^\[]*", "\n", text)
    path = folder / "split.toml"
    path.write_text(text)
    return path, [f"motion.file={EXAMPLES / 'records/imperial_valley_1979_meloland_freefield.csv'}",
                  "motion.column_long=1", "motion.column_lat=2", "motion.scale=1",
                  f"node.xpc.constants={EXAMPLES / 'srmd_platen_constants.toml'}", "uncompensated={}",
                  "model.specimen.lead_heating.enabled=true"]


def split_of(axis):
    bands = axis["tracking_bands"]
    rest = axis["nrms_percent"] ** 2 - sum(band["nrms_percent"] ** 2 for band in bands)
    return {"delay_ms": axis["delay_compensated_ms"], "window_ms": axis["delay_in_windows_max_ms"],
            "nrms_percent": axis["nrms_percent"], "rest_percent": math.sqrt(max(0.0, rest)),
            "bands": [{"name": f"{band['from_Hz']:g} to {band['to_Hz']:g} Hz", "nrms_percent": band["nrms_percent"],
                       "command_percent": band["command_percent"]} for band in bands]}


def measure(rths, seconds):
    found = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        file, common = experiment(folder)
        for run, changes in RUNS.items():
            out = folder / run.replace(" ", "_")
            options = set_options([*common, f"duration_s={seconds}", *changes])
            subprocess.run([rths, "run", str(file), "--clock", "virtual", "--no-diagnosis", "--out", str(out), *options],
                           stdout=subprocess.DEVNULL, check=True)
            axes = json.loads((out / "report.json").read_text())["axes"]
            found.append({"name": run} | {axis: split_of(axes[axis]) for axis in ("long", "lat")})
            print(run, *(f"{axis} {found[-1][axis]['nrms_percent']:.3f} %" for axis in ("long", "lat")), flush=True)
    return found


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("rths")
    arguments.add_argument("--seconds", type=float, default=30, help="duration of a run, model time")
    options = arguments.parse_args()
    of_commit = commit()
    runs = measure(options.rths, options.seconds)
    write(RESULTS / "tracking_split.json",
          stamp(of_commit) | {"machine": machine(), "duration_s": options.seconds, "runs": runs})


if __name__ == "__main__":
    main()

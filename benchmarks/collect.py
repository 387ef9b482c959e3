#!/usr/bin/env python3
"""Puts the benchmarks of a folder into one table, and into files if asked.

usage: collect.py FOLDER COMMIT [RESULTS]

Leaves loop.json, what a step costs, ring.json, how fast the ring is, bearings.json, what a step
of a bearing takes beside OpenSees, and opensees.json, the way from OpenSees to a specimen and back, in the folder RESULTS.
"""
import datetime
import json
import os
import pathlib
import platform
import sys


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                  if line.startswith("model name")), platform.machine())
    return {"cpu": model, "cpus": os.cpu_count(), "kernel": platform.release()}


def median_and_spread(file):
    rows = {row["aggregate_name"]: row["real_time"] for row in json.load(open(file))["benchmarks"]}
    return {"median_ns": round(rows["median"], 2), "stddev_ns": round(rows["stddev"], 2)}


def write(path, result):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(result, indent=2) + "\n")
    print(f"wrote {path}")


def print_bearings(result):
    for row in result["bearings"]:
        times, theirs = row["earthquake"], row["opensees"]
        beside = (f"OpenSees {theirs['further_ns']:.0f} ns" if "further_ns" in theirs
                  else f"OpenSees not measured: {theirs['not_measured']}")
        print(f"  bearing {row['name']:<22} {times['p50_ns']:>10.1f} ns  p99 {times['p99_ns']:.0f} ns, "
              f"adversity {row['adversarial']['worst_code_ns']:.0f} ns, {row['verdict']}; {beside}")
    print(f"  bearings: {result['result']}", *result["troubles"], sep="\n    ")


def print_trips(result):
    for trip in result["trips"]:
        print(f"  OpenSees and back, {trip['protocol']}        {trip['through_ring']['p50_ns'] / 1e3:>8.1f} us, "
              f"{trip['ratio_p50']:.2f} times a bare ping-pong, {trip['verdict']}")


def main():
    folder, commit = pathlib.Path(sys.argv[1]), sys.argv[2]
    stamp = {
        "commit": commit,
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
    }
    result = stamp | {
        "machine": machine(),
        "steps": {file.stem: median_and_spread(file) for file in sorted(folder.glob("*.json"))},
    }
    run = json.load(open(folder / "virtual" / "report.json"))
    result["virtual_run"] = {"test_s": run["duration_s"],
                             "times_real_time": run["meta"].get("times_real_time")}
    print(f"{machine()['cpu']}, {machine()['cpus']} CPUs, commit {commit}")
    for name, row in result["steps"].items():
        part = row["median_ns"] / 1e6 * 100
        print(f"  {name:<30} {row['median_ns']:>10.1f} ns  {part:8.4f} % of a control period")
    print(f"  a run in virtual time          {result['virtual_run']['times_real_time']} times real time")
    bearings = json.load(open(folder / "bearings" / "result.json"))
    print_bearings(bearings)
    trips = json.load(open(folder / "opensees" / "result.json"))
    print_trips(trips)
    if len(sys.argv) > 3:
        results = pathlib.Path(sys.argv[3])
        write(results / "loop.json", result)
        write(results / "ring.json", stamp | json.load(open(folder / "ring" / "result.json")))
        write(results / "bearings.json", stamp | bearings)
        write(results / "opensees.json", stamp | trips)


main()

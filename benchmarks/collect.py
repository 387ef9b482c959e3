#!/usr/bin/env python3
"""Prints the benchmarks of a folder as a table and, if a results folder is given, writes result files.

usage: collect.py FOLDER COMMIT [RESULTS]

Writes to RESULTS:
  loop.json      time of one step of each part of the loop
  ring.json      latency and throughput of the ring
  bearings.json  time of a bearing step here and in OpenSees
  opensees.json  round trip from OpenSees to a specimen and back
  bridge.json    from one ring to another over DDS
"""
import json
import pathlib
import sys

from results_file import machine, stamp, write


def median_and_spread(file):
    rows = {row["aggregate_name"]: row["real_time"] for row in json.load(open(file))["benchmarks"]}
    return {"median_ns": round(rows["median"], 2), "stddev_ns": round(rows["stddev"], 2)}


def print_steps(result):
    print(f"{result['machine']['cpu']}, {result['machine']['cpus']} CPUs, commit {result['commit']}")
    for name, row in result["steps"].items():
        share = row["median_ns"] / 1e6 * 100
        print(f"  {name:<30} {row['median_ns']:>10.1f} ns  {share:8.4f} % of a control period")
    print(f"  a run in virtual time          {result['virtual_run']['times_real_time']} times real time")


def print_bearings(result):
    for row in result["bearings"]:
        times, opensees = row["earthquake"], row["opensees"]
        comparison = (f"OpenSees {opensees['further_ns']:.0f} ns" if "further_ns" in opensees
                      else f"OpenSees not measured: {opensees['not_measured']}")
        print(f"  bearing {row['name']:<22} {times['p50_ns']:>10.1f} ns  p99 {times['p99_ns']:.0f} ns, "
              f"adversity {row['adversarial']['worst_code_ns']:.0f} ns, {row['verdict']}; {comparison}")
    print(f"  bearings: {result['result']}", *result["troubles"], sep="\n    ")


def print_trips(result):
    for trip in result["trips"]:
        print(f"  OpenSees round trip, {trip['protocol']}       {trip['through_ring']['p50_ns'] / 1e3:>8.1f} us, "
              f"{trip['ratio_p50']:.2f} times a bare ping-pong, {trip['verdict']}")


def print_bridge(result):
    updates, latency, resync, load = result["rows"]
    print(f"  over DDS  {updates['updates_per_s'] / 1e6:.1f} million updates/s, {updates['updates_ratio']:.0f} times bare "
          f"samples; one way {latency['through_ring']['p50_ns'] / 1e3:.0f} us, {latency['latency_ratio_p50']:.2f} times; "
          f"8 MiB in {resync['seconds'] * 1e3:.0f} ms; {result['result']}", *result["troubles"], sep="\n    ")


def main():
    folder, commit = pathlib.Path(sys.argv[1]), sys.argv[2]
    stamped = stamp(commit)
    run = json.load(open(folder / "virtual" / "report.json"))
    loop = stamped | {
        "machine": machine(),
        "steps": {file.stem: median_and_spread(file) for file in sorted(folder.glob("*.json"))},
        "virtual_run": {"test_s": run["duration_s"], "times_real_time": run["meta"].get("times_real_time")},
    }
    bearings = json.load(open(folder / "bearings" / "result.json"))
    trips = json.load(open(folder / "opensees" / "result.json"))
    print_steps(loop)
    print_bearings(bearings)
    print_trips(trips)
    bridge = json.load(open(folder / "bridge" / "result.json"))
    print_bridge(bridge)
    if len(sys.argv) > 3:
        results = pathlib.Path(sys.argv[3])
        write(results / "loop.json", loop)
        write(results / "ring.json", stamped | json.load(open(folder / "ring" / "result.json")))
        write(results / "bearings.json", stamped | bearings)
        write(results / "opensees.json", stamped | trips)
        write(results / "bridge.json", stamped | bridge)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scores the diagnosis on cases whose answers it cannot read.

    trial_score.py --rths PATH --out DIR --cases DIR --answers DIR      existing cases
    trial_score.py --rths PATH --out DIR --generator PATH --seed S      makes the cases first
        [--tier A] [--library 60] [--none 20] [--outside 20]
    [--only K …]  these cases only    [--jobs N]  in parallel    [--json FILE]  writes all results
    [--short]     for few cases: fails only on results with a probability of 1 % or less at the required rates

Runs the command as a user does, on a copy of each case in its own folder. Prints a line for each case and
the score table; docs/diagnosis_trials.md defines its rows. Exits with 1 if a required value is missed.
Uses Python's standard library only and no code of the diagnosis.
"""
import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

import laboratory
from judge import judge
from table import print_cases, print_table, score


def read_options():
    parser = argparse.ArgumentParser(usage=__doc__.replace("%", "%%"))
    parser.add_argument("--rths", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--cases", type=pathlib.Path)
    parser.add_argument("--answers", type=pathlib.Path)
    parser.add_argument("--generator", type=pathlib.Path)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--tier", default="A")
    parser.add_argument("--library", type=int, default=60)
    parser.add_argument("--none", type=int, default=20)
    parser.add_argument("--outside", type=int, default=20)
    parser.add_argument("--only", type=int, nargs="+")
    parser.add_argument("--jobs", type=int, default=len(laboratory.cores()))
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--short", action="store_true")
    options = parser.parse_args()
    if not (options.generator and options.seed is not None) and not (options.cases and options.answers):
        parser.error("give --cases and --answers, or --generator and --seed")
    options.rths, options.out = options.rths.resolve(), options.out.resolve()
    return options


def prepare(options):
    """@returns folders of the cases, folder of the answers"""
    if options.generator is None:
        cases, answers = options.cases, options.answers
        numbers = [int(file.stem.removeprefix("case_")) for file in answers.glob("case_*.json")]
    else:
        wanted = {"library": options.library, "none": options.none, "outside": options.outside}
        generator = options.generator.resolve()
        numbers = laboratory.planned(generator, options.seed, options.tier, wanted)
        made = f"{options.tier}-{options.seed}-{laboratory.digest(generator)[:12]}"
        cases, answers = laboratory.make_cases(generator, options.seed, options.tier, numbers,
                                               options.out / made, options.jobs)
    numbers = [n for n in sorted(numbers) if not options.only or n in options.only]
    return [cases / f"case_{n}" for n in numbers], answers


def commit():
    here = pathlib.Path(__file__).parent
    git = ["git", "-c", "safe.directory=*", "-C", str(here)]
    try:
        known = subprocess.run([*git, "rev-parse", "--short", "HEAD"], check=True,
                               capture_output=True, text=True).stdout.strip()
        clean = subprocess.run([*git, "diff", "--quiet", "HEAD"], check=False).returncode == 0
        return known + ("" if clean else "-dirty")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                  if line.startswith("model name")), platform.machine())
    return {"cpu": model, "cpus": os.cpu_count(), "kernel": platform.release()}


def write(file, options, seeds, table, rows):
    result = {
        "commit": commit(),
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "machine": machine(), "command": laboratory.digest(options.rths),
        "seed": seeds[0], "tier": seeds[1],
        "score": {row.key: {"label": row.label} | row.as_json() for row in table},
        "cases": rows,
    }
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")


def main():
    options = read_options()
    cases, folder = prepare(options)
    answers = {case: json.loads((folder / f"{case.name}.json").read_text()) for case in cases}
    seeds = sorted({(answer["seed"], answer["tier"]) for answer in answers.values()})
    if len(seeds) != 1:
        sys.exit(f"{folder}: answers of {len(seeds)} seeds and tiers, expected one")
    seed, tier = int(seeds[0][0]), seeds[0][1]
    print(f"seed {seed}, tier {tier}, {len(cases)} cases", flush=True)
    rows = []

    def keep(case, result):
        row = judge(result["verdict"], answers[case])
        row |= {"cpu_s": result["cpu_s"], "wall_s": result["wall_s"], "status": result["status"]}
        rows.append(row)
        print_cases([row])
        sys.stdout.flush()

    laboratory.diagnose_all(options.rths, cases, options.out / "verdicts", options.jobs, keep)
    table = score(rows)
    print(f"\nseed {seed}, tier {tier}")
    print_table(table)
    if options.json:
        write(options.json, options, (seed, tier), table, rows)
    bad = [row.label.strip() for row in table
           if (row.is_refuted() if options.short else not row.is_met())]
    print("\nmissed: " + "; ".join(bad) if bad else "\nall required values are met")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

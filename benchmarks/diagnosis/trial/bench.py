#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trial of the diagnosis: makes cases that conceal effects, seals the answers, diagnoses, then scores.

    rths bench diagnosis [--cases N] [--family F] [--seed S] [--json FILE]

docs/diagnosis_trials.md defines families, quantities and goals. Everything lies in --out; an interrupted run resumes.
"""
import argparse
import concurrent.futures
import datetime
import hashlib
import json
import os
import pathlib
import platform
import subprocess
import sys

os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # cases run in parallel
try:
    import numpy  # noqa: F401
except ImportError:
    sys.exit(f"{sys.executable}: has no NumPy, expected a Python with NumPy and OpenSees, such as that of ./lab")

import laboratory  # noqa: E402
import peers  # noqa: E402
from families import CASES_A_TURN, FAMILIES, name_of  # noqa: E402
from judge import judge  # noqa: E402
from results import by_family_and_tier, is_right, text_of  # noqa: E402
from sentences import faults_of, units_of  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
USUAL_CASES = 500
MAKING_LIMIT_S = 900


def read_options():
    parser = argparse.ArgumentParser(prog="rths bench diagnosis", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=USUAL_CASES, help="in all families together (500)")
    parser.add_argument("--family", action="append", choices=list(FAMILIES), help="only this one; repeatable")
    parser.add_argument("--seed", type=int, help="default: from the commit")
    parser.add_argument("--json", type=pathlib.Path, help="writes results to this file")
    parser.add_argument("--out", type=pathlib.Path, help="default: out/bench/diagnosis-SEED")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path("../shared/data"), help="recordings and motions")
    parser.add_argument("--no-peers", action="store_true", help="the diagnosis alone")
    parser.add_argument("--peer-cases", type=int, help="the peers get only so many cases, the first; default: all")
    parser.add_argument("--require", type=float, help="fails if a smaller share of the detectable cases is right")
    parser.add_argument("--jobs", type=int, default=len(laboratory.cores()))
    parser.add_argument("--rths", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    options = parser.parse_args()
    for name, count in (("--cases", options.cases), ("--peer-cases", options.peer_cases)):
        if count is not None and count < 1:
            parser.error(f"{name}: expected at least 1")
    options.commit = commit()
    if options.seed is None:
        if options.commit == "unknown":
            parser.error("--seed: expected a number, because no commit is known here")
        options.seed = int(options.commit[:8], 16)
    options.family = list(dict.fromkeys(options.family or FAMILIES))
    options.data = options.data.resolve()
    options.out = (options.out or pathlib.Path(f"out/bench/diagnosis-{options.seed}")).resolve()
    options.rths = options.rths.resolve()
    return options


def commit():
    git = ["git", "-c", "safe.directory=*", "-C", str(HERE)]
    try:
        known = subprocess.run([*git, "rev-parse", "--short=12", "HEAD"], check=True, capture_output=True, text=True).stdout.strip()
        of_code = [":/", ":(top,exclude)benchmarks/results", ":(top,exclude,glob)**/*.md"]
        clean = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", *of_code], check=False).returncode == 0
        return known + ("" if clean else "-dirty")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def records_of(options):
    """Ground motions of the source tree, or of the installation."""
    for folder in (HERE.parents[2] / "examples/records", options.rths.parent / "../share/rths/examples/records"):
        if folder.is_dir():
            return folder.resolve()
    sys.exit(f"{HERE}: found no examples/records beside it, expected ground motions there")


def planned(options):
    """(family, number) of each case: the families take turns, some with several cases a turn."""
    if not options.family:
        sys.exit("no family is left, expected one with data")
    turn = [family for family in options.family for _ in range(CASES_A_TURN.get(family, 1))]
    counts, plan = dict.fromkeys(turn, 0), []
    for k in range(options.cases):
        family = turn[k % len(turn)]
        plan.append((family, counts[family]))
        counts[family] += 1
    return plan


def keep_makers(options):
    """SHA-256 of the programs that make and score the cases. Ends the run if --out has cases of others."""
    generator = options.rths.parent / "trial_generator"
    makers = {"scripts": laboratory.digest(*sorted(HERE.glob("*.py")))}
    if "own" in options.family and generator.is_file():
        makers["trial_generator"] = laboratory.digest(generator)
    if "program" in options.family and generator.with_name("trial_fmu.so").is_file():
        makers["trial_fmu"] = laboratory.digest(generator.with_name("trial_fmu.so"))
    if "laboratory" in options.family:
        makers["rths"] = laboratory.digest(options.rths)
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / "makers.json"
    known = json.loads(kept.read_text()) if kept.is_file() else {}
    for name, digest in makers.items():
        if known.get(name, digest) != digest:
            sys.exit(f"{options.out}: its cases were made with other {name}, expected the same, or another --out")
    kept.write_text(json.dumps(known | makers, indent=1) + "\n")


def make_cases(options, plan):
    """Makes missing cases and answers. @returns families that lack their data, with the reason"""
    for folder in ("cases", "answers"):
        (options.out / folder).mkdir(parents=True, exist_ok=True)
    sources = {"data": str(options.data.resolve()), "records": str(records_of(options)), "rths": str(options.rths),
               "generator": str(options.rths.parent / "trial_generator"),
               "laboratory": str(records_of(options).parent / "srmd_lprb_2d.toml")}

    def make(one):
        family, number = one
        name = name_of(family, number)
        case, answer = options.out / "cases" / name, options.out / "answers" / f"{name}.json"
        if case.is_dir() and answer.is_file():
            return None
        task = {"family": family, "number": number, "seed": options.seed, "sources": sources, "case": str(case),
                "answer": str(answer)}
        made = subprocess.run([sys.executable, str(HERE / "make_case.py"), json.dumps(task)], capture_output=True, text=True,
                              timeout=MAKING_LIMIT_S, check=False, env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
        if made.returncode != 0 or not answer.is_file():
            reason = [line for line in (made.stderr or made.stdout).splitlines() if "Error" in line]
            return name, (reason or ["it failed"])[-1]
        return None

    failed = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for count, failure in enumerate(pool.map(make, plan), 1):
            if failure:
                failed.append(failure)
                print(f"{failure[0]}: not made: {failure[1]}", flush=True)
            progress(f"made {count} of {len(plan)}")
    return failed


def progress(text):
    if sys.stderr.isatty():
        print(f"\r{text:<60}", end="", file=sys.stderr, flush=True)


def seal(options, plan):
    """SHA-256 of each answer, written before the first diagnosis. Ends the run if an answer changed since."""
    found = {}
    for family, number in plan:
        file = options.out / "answers" / f"{name_of(family, number)}.json"
        if file.is_file():
            found[name_of(family, number)] = hashlib.sha256(file.read_bytes()).hexdigest()
    kept = options.out / "sealed.json"
    known = json.loads(kept.read_text()) if kept.is_file() else {}
    for name, digest in found.items():
        if known.get(name, digest) != digest:
            sys.exit(f"{options.out}/answers/{name}.json: SHA-256 is {digest}, sealed as {known[name]}")
    kept.write_text(json.dumps(known | found, indent=1) + "\n")
    whole = hashlib.sha256(json.dumps(found, sort_keys=True).encode()).hexdigest()
    print(f"sealed {len(found)} answers, SHA-256 {whole}", flush=True)
    return found, whole


def diagnose(options, sealed):
    """Scored rows of the tool."""
    rows, of_controls = [], {}
    answers = {name: json.loads((options.out / "answers" / f"{name}.json").read_text()) for name in sealed}

    def keep_control(control, result):
        of_controls[control.name] = result["verdict"]

    def keep(case, result):
        answer = answers[case.name]
        row = judge(result["verdict"], answer, of_controls.get(answer.get("control"))) | {key: result[key] for key in ("cpu_s", "wall_s", "status")}
        row["faults"] = faults_of(result["verdict"], units_of(options.out / "verdicts" / case.name))
        rows.append(row)
        print_case(row)

    controls = [options.out / "cases" / answer["control"] for answer in answers.values() if answer.get("control")]
    laboratory.diagnose_all(options.rths, controls, options.out / "verdicts", options.jobs, keep_control)
    cases = [options.out / "cases" / name for name in sealed]
    laboratory.diagnose_all(options.rths, cases, options.out / "verdicts", options.jobs, keep)
    return rows


def print_case(row):
    truth = " + ".join(row["truth"]) or "none"
    named = ", ".join(row["names"]) or "-"
    mark = " " if is_right(row) else "." if row["kind"] not in ("none",) and not row["detectable"] else "x"
    forms = f" [{row['forms'][0]}]" if row["forms"] and row["outcome"] == "unknown" else ""
    known = f"{row['information']:.0f} nat" if "information" in row else ""
    tie = " tie" if row.get("distinguishable") is False else ""
    print(f"{row['case']:<16}{mark} {row['tier']:<11}{truth:<44}{known + tie:<16}{row['outcome']}: {named}{forms}"
          f"  {row['cpu_s']:.1f} s", flush=True)


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")),
                 platform.machine())
    return {"cpu": model, "cpus": os.cpu_count(), "kernel": platform.release()}


def main():
    options = read_options()
    if "recordings" in options.family and not (options.data / "emps").is_dir():
        print(f"recordings: skipped, found no {options.data / 'emps'}")
        options.family.remove("recordings")
    plan = planned(options)
    print(f"seed {options.seed} (commit {options.commit}), {len(plan)} cases of {', '.join(options.family)}\n{options.out}",
          flush=True)
    keep_makers(options)
    failed = make_cases(options, plan)
    sealed, whole = seal(options, plan)
    rows = diagnose(options, sealed)
    table = by_family_and_tier(rows)
    print("\n" + text_of(table))
    rivals = {} if options.no_peers else compared(options, plan, sealed, rows)
    if options.json:
        result = {"commit": options.commit, "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
                  "machine": machine(), "command": laboratory.digest(options.rths), "seed": options.seed,
                  "sealed_sha256": whole, "answers_sha256": sealed, "not_made": dict(failed), "families": table,
                  "rows": rows} | rivals
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")
    return exit_code(rows, failed, options.require)


def compared(options, plan, sealed, rows):
    """Quantities of the peers and of the tool on the peers' cases; `within`: with effects of the peers' library alone."""
    first = [name_of(*one) for one in plan[:options.peer_cases] if name_of(*one) in sealed]
    own = [row for row in rows if row["case"] in first]
    result = {"peers_cases": len(first), "peers_own": by_family_and_tier(own), "peers": {}, "peers_within": {}}
    for name in peers.METHODS:
        theirs = peers.scored(name, options.out, first, options.jobs)
        within = [row for row in theirs if row["in_library"]]
        result["peers"][name] = by_family_and_tier(theirs)
        result["peers_within"][name] = by_family_and_tier(within)
        print(f"\n{name}\n" + text_of(result["peers"][name]))
    known = {row["case"] for row in within}  # the library is one for both
    return result | {"peers_own_within": by_family_and_tier([row for row in own if row["case"] in known])}


def exit_code(rows, failed, required):
    """0: all detectable cases are right; 1: one is wrong; 2: one is missing, or fewer than the required share are right."""
    seen = [row for row in rows if row["kind"] == "none" or row["detectable"]]
    right = sum(1 for row in seen if is_right(row))
    print(f"\n{right} of {len(seen)} detectable cases are right")
    if failed or any(row["outcome"] == "failed" for row in rows) or required is not None and right < required * len(seen):
        return 2
    return 0 if right == len(seen) else 1


if __name__ == "__main__":
    sys.exit(main())

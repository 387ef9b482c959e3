# SPDX-License-Identifier: Apache-2.0
"""Cases of the trial's own generator in C++ (../generator), a closed-loop test of a lead-rubber bearing."""
import json
import os
import shutil
import subprocess
import tempfile

# Letter of the generator's tier and kind of each case, repeated.
SLOTS = (("A", "library"), ("D", "pair"), ("A", "none"), ("A", "outside"), ("B", "library"), ("C", "library"),
         ("E", "library"), ("E", "none"), ("D", "pair"), ("A", "library"))
TIERS = {"A": "standard", "B": "small", "C": "noisy", "D": "pairs", "E": "wrong_rule"}
MANY = 2000  # cases that a list shows; kinds are rare: one case in 14 conceals nothing


def _lines(command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def _of_kind(generator, seed, tier, kind, count):
    """Number of the generator's case that is the `count`-th of its kind."""
    home = dict(line.split("\t")[::3] for line in _lines([generator, "--effects"]))
    for line in _lines([generator, "--seed", str(seed), "--tier", tier, "--cases", str(MANY), "--list"]):
        if not line.startswith("case_"):
            continue
        case, truth = line.split("\t")
        found = "none" if truth == "none" else "pair" if " + " in truth else home[truth]
        if found == kind:
            if count == 0:
                return int(case.removeprefix("case_"))
            count -= 1
    raise LookupError(f"seed {seed}, tier {tier}: fewer than {count} cases of kind {kind} in {MANY}")


def slot_of(number):
    """Tier and kind of a case, and how many of the same came before."""
    own = SLOTS[number % len(SLOTS)]
    before = sum(SLOTS[n % len(SLOTS)] == own for n in range(number))
    return own, before


def make(number, seed, folder, sources):
    """Writes the case; returns its answer."""
    (letter, kind), before = slot_of(number)
    chosen = _of_kind(sources["generator"], seed, letter, kind, before)
    motions = ["--motions", str(sources["data"] / "ground_motions"), "--records", str(sources["records"])]
    with tempfile.TemporaryDirectory(dir=folder.parent) as made:
        subprocess.run([sources["generator"], "--seed", str(seed), "--tier", letter, "--only", str(chosen),
                        "--truth", "--out", made, *motions], check=True, capture_output=True)
        shutil.rmtree(folder, ignore_errors=True)
        os.replace(f"{made}/case_{chosen}", folder)
        with open(f"{made}/answers/case_{chosen}.json") as file:
            answer = json.load(file)
    return answer | {"tier": TIERS[letter], "kind": kind, "number_of_generator": chosen}

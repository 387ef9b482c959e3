#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes one case and its answer: make_case.py TASK.json, in a process of its own because OpenSees has one state."""
import json
import pathlib
import shutil
import sys

import families


def main():
    task = json.loads(sys.argv[1])
    sources = {key: pathlib.Path(value) if key != "generator" else value for key, value in task["sources"].items()}
    case, answer = pathlib.Path(task["case"]), pathlib.Path(task["answer"])
    part = case.with_name(case.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    made = families.make(task["family"], task["number"], task["seed"], part, sources)
    shutil.rmtree(case, ignore_errors=True)
    part.rename(case)
    answer.write_text(json.dumps(made, indent=1) + "\n")


main()

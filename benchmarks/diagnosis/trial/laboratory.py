# SPDX-License-Identifier: Apache-2.0
"""Runs the tool on cases. Existing verdicts are kept."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import queue
import shutil
import subprocess
import tempfile
import time

LIMIT_S = 600  # of processor time: a longer case counts as failed, whatever else the host does
WAIT_S = 6 * LIMIT_S  # on the clock: a case that waits for nothing


def digest(*files):
    whole = hashlib.sha256()
    for file in files:
        whole.update(pathlib.Path(file).read_bytes())
    return whole.hexdigest()


def cores():
    return sorted(os.sched_getaffinity(0))


def _timed(command, log, core):
    """Runs on one core. @returns exit status, processor seconds, clock seconds"""
    begun = time.monotonic()
    with open(log, "wb") as out:
        child = subprocess.Popen(["taskset", "-c", str(core), "prlimit", f"--cpu={LIMIT_S}:{LIMIT_S + 1}", *command],
                                 stdout=out, stderr=subprocess.STDOUT)
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            taken = time.monotonic() - begun
            if pid:
                child.returncode = os.waitstatus_to_exitcode(status)
                return child.returncode, usage.ru_utime + usage.ru_stime, taken
            if taken > WAIT_S:
                child.kill()
            time.sleep(0.01)


def diagnose(tool, case, out, core):
    """Runs the tool on a copy of the case in its own folder, without access to answers.

    @returns {"verdict", "cpu_s", "wall_s", "status"}; the verdict is None if the tool wrote none
    """
    stamp = {"tool": digest(tool), "case": digest(*sorted(case.iterdir()))}
    run, told = out / "run.json", out / "verdict.json"
    if run.exists():
        known = json.loads(run.read_text())
        if known["stamp"] == stamp:
            return known | {"verdict": json.loads(told.read_text()) if told.exists() else None}
    shutil.rmtree(out, ignore_errors=True)
    with tempfile.TemporaryDirectory() as alone:
        shutil.copytree(case, f"{alone}/{case.name}")
        shown = pathlib.Path(alone, "verdict")
        shown.mkdir()
        command = [str(tool), "diagnose", f"{alone}/{case.name}", "--out", str(shown)]
        status, cpu, wall = _timed(command, f"{alone}/log.txt", core)
        shutil.copytree(shown, out)
        shutil.copy(f"{alone}/log.txt", out / "log.txt")
    known = {"stamp": stamp, "status": status, "cpu_s": cpu, "wall_s": wall}
    run.write_text(json.dumps(known))
    return known | {"verdict": json.loads(told.read_text()) if told.exists() else None}


def diagnose_all(tool, cases, out, jobs, then):
    """Runs the tool on every case, each on its own core; calls `then` with folder and result."""
    free = queue.Queue()
    for core in (cores() * jobs)[:jobs]:
        free.put(core)

    def one(case):
        core = free.get()
        try:
            return case, diagnose(tool, case, out / case.name, core)
        finally:
            free.put(core)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for case, result in pool.map(one, cases):
            then(case, result)

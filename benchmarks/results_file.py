"""Result files of the benchmarks: each names the commit, the date and the machine of its measurement."""
import datetime
import json
import os
import pathlib
import platform
import subprocess

TREE = pathlib.Path(__file__).resolve().parents[1]
RESULTS = TREE / "benchmarks" / "results"


def machine():
    """Processor, number of processors and kernel of this machine."""
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                  if line.startswith("model name")), platform.machine())
    return {"cpu": model, "cpus": os.cpu_count(), "kernel": platform.release()}


def commit():
    """Short hash of the checked-out commit, with "-dirty" if tracked files other than results and pages differ from it."""
    git = ["git", "-c", f"safe.directory={TREE}", "-C", str(TREE)]
    name = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True)
    is_clean = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", ".", ":!benchmarks/results", ":!*.md"]).returncode == 0
    return name.stdout.strip() + ("" if is_clean else "-dirty")


def stamp(of_commit):
    """Commit and date (UTC) of a measurement that ends now."""
    now = datetime.datetime.now(datetime.timezone.utc)
    return {"commit": of_commit, "date": now.isoformat(timespec="seconds")}


def write(path, result):
    """Writes a result file and prints its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(result, indent=2, ensure_ascii=False) + "\n")
    print(f"wrote {path}")


def set_options(changes):
    """Options of the command that set keys of an experiment, "key=value" each."""
    return [part for change in changes for part in ("--set", change)]

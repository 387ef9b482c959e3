#!/usr/bin/env python3
"""Runs a command, its output in a log, and shows its progress on standard error.

    progress.py LABEL COMMAND…

Prints the newest "k of n" in the log, as ninja and ctest write it, and the elapsed time: each second on a terminal, else
every 30 s. Prints the log if the command fails, and ends with its status. Standard library only.
"""
import re
import subprocess
import sys
import tempfile
import time

STEP = re.compile(r"^(?:\[(\d+)/(\d+)\]| *(\d+)/(\d+) Test )", re.MULTILINE)


def say(text):
    print(f"lab: {text}", file=sys.stderr, flush=True)


def newest_step(log):
    """The last "k of n" in a log."""
    found = [match for match in STEP.finditer(log)]
    return "{} of {}".format(*(group for group in found[-1].groups() if group)) if found else "started"


class Progress:
    """A line about a log, at its times."""

    def __init__(self, label, log, period=30):
        self.label, self.log = label, log
        self.begun = self.shown = time.monotonic()
        self.is_terminal = sys.stderr.isatty()
        self.period = 1 if self.is_terminal else period

    def show(self):
        now = time.monotonic()
        if now - self.shown < self.period:
            return
        self.shown = now
        with open(self.log, "rb") as log:
            log.seek(max(0, log.seek(0, 2) - 4000))
            step = newest_step(log.read().decode(errors="replace"))
        line = f"lab: {self.label}: {step}, {now - self.begun:.0f} s"
        print(f"\r{line}\033[K" if self.is_terminal else line, end="" if self.is_terminal else "\n", file=sys.stderr, flush=True)

    def end(self):
        if self.is_terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def watched(label, command, log, period=30, **options):
    """Runs the command with its output in the log; its exit status."""
    with open(log, "wb") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, **options)
    progress = Progress(label, log, period)
    try:
        while process.poll() is None:
            time.sleep(0.1)
            progress.show()
    except BaseException:
        process.terminate()
        process.wait()
        raise
    progress.end()
    return process.returncode


def main():
    with tempfile.NamedTemporaryFile() as log:
        status = watched(sys.argv[1], sys.argv[2:], log.name)
        if status != 0:
            sys.stderr.write(open(log.name, errors="replace").read())
    return status if status >= 0 else 128 - status


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""The Python package of rths: rings, recordings, runs and diagnoses.

    ring = rths.attach("srmd_lprb_2d")            a ring of this host
    run = rths.run("experiment.toml")             runs the installed command
    frame = rths.load("out/demo")                 a recording as a pandas DataFrame
    verdict = rths.diagnose("out/demo")           the physics that the simulation left out
    found = rths.compare("out/demo", "out/other")  two runs, signal by signal
    page = rths.view("srmd_lprb_2d")              a live page of a ring

All values are in SI. Every error of rths is an `rths.Error`, with one line: place, found, expected. `rths.testing` is the
plugin for pytest.
"""
from ._rths import Error, LostWrites
from .adapter import Adapter, Input, Monitor, Output, Parameter, Status
from .comparison import ComparedSignal, Comparison, compare
from .installation import command
from .recording import Recording, load
from .ring import Follower, Node, Ring, Signal, Write, attach, create_ring, in_process_ring, ring_names
from .runs import Cause, Run, Verdict, diagnose, run
from .watching import View, view

for _error in (Error, LostWrites):
    _error.__module__ = "rths"

__all__ = [
    "Adapter", "Cause", "ComparedSignal", "Comparison", "Error", "Follower", "Input", "LostWrites", "Monitor", "Node",
    "Output", "Parameter", "Recording", "Ring", "Run", "Signal", "Status", "Verdict", "View", "Write", "attach", "command",
    "compare", "create_ring", "diagnose", "in_process_ring", "load", "ring_names", "run", "view",
]

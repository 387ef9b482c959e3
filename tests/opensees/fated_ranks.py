#!/usr/bin/env python3
"""Two masses on springs and an experimental bearing, on two ranks; a rank or the model fails in a given way.

usage: fated_ranks.py PORT leave|kill|behead|fail|vanish|freeze|late|loop|twice|bearings STEPS [FILE]

With FILE, rank 0 creates it after the steps and goes on without an end.
"""
import os
import signal
import sys
import time

import openseespy.opensees as ops

port, fate, steps = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
rank = ops.getPID()
if fate == "late" and rank == 1:
    time.sleep(3600)
while fate == "loop" and rank == 1:
    pass
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
if rank == 0 or fate == "twice":
    ops.mass(1, 1e6)
if rank == 0 or fate == "bearings":
    ops.element("genericClient", 1, "-node", 1, "-dof", 1, "-server", port, "127.0.0.1")
if rank == 1:
    ops.node(2, 0.0)
    ops.mass(2, 2e6)
    ops.uniaxialMaterial("Elastic", 1, 1e9)
    ops.element("zeroLength", 2, 1, 2, "-mat", 1, "-dir", 1)
ops.timeSeries("Trig", 1, 0.0, 1e3, 2.0, "-factor", 3.0)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.constraints("Plain")
ops.numberer("ParallelPlain")
ops.system("Mumps")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 0.95)
ops.analysis("Transient")
ops.analyze(steps, 0.01)
if len(sys.argv) > 4:
    if rank == 0:
        open(sys.argv[4], "w").close()
    while ops.analyze(1, 0.01) == 0:
        pass
if rank == (0 if fate == "behead" else 1) and fate in ("kill", "behead"):
    os.kill(os.getpid(), signal.SIGKILL)
elif rank == 1 and fate == "fail":
    raise RuntimeError("there is no more ground to shake")
elif rank == 1 and fate == "vanish":
    os._exit(0)
elif rank == 1 and fate == "freeze":
    os.kill(os.getpid(), signal.SIGSTOP)
ops.analyze(steps if fate != "leave" else 1, 0.01)
ops.wipe()

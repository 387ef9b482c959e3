#!/usr/bin/env python3
"""A mass on an experimental bearing; the script fails in a given way after some steps.

usage: fated.py PORT kill|freeze|fail|vanish|leave STEPS
"""
import os
import signal
import sys

import openseespy.opensees as ops

port, fate, steps = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.mass(1, 1e6)
ops.element("genericClient", 1, "-node", 1, "-dof", 1, "-server", port, "127.0.0.1")
ops.timeSeries("Trig", 1, 0.0, 1e3, 2.0, "-factor", 3.0)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 0.95)
ops.analysis("Transient")
ops.analyze(steps, 0.01)
if fate == "kill":
    os.kill(os.getpid(), signal.SIGKILL)
elif fate == "freeze":
    os.kill(os.getpid(), signal.SIGSTOP)
elif fate == "fail":
    print("there is no more ground to shake", file=sys.stderr, flush=True)
    os._exit(3)
elif fate == "vanish":
    os._exit(0)
ops.wipe()

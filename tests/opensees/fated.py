#!/usr/bin/env python3
"""A mass on an experimental bearing; the script fails in a given way after some steps.

usage: fated.py PORT kill|freeze|fail|vanish|leave|halve STEPS [STEP_S]

With halve, the next step fails and is repeated in four parts, and as many steps follow.
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
step = float(sys.argv[4]) if len(sys.argv) > 4 else 0.01
ops.analyze(steps, step)
if fate == "kill":
    os.kill(os.getpid(), signal.SIGKILL)
elif fate == "freeze":
    os.kill(os.getpid(), signal.SIGSTOP)
elif fate == "fail":
    print("there is no more ground to shake", file=sys.stderr, flush=True)
    os._exit(3)
elif fate == "vanish":
    os._exit(0)
elif fate == "halve":
    ops.algorithm("Newton", "-initial")
    ops.test("NormDispIncr", 1e-14, 1, 0)
    if ops.analyze(1, step) == 0:
        sys.exit("the step did not fail")
    ops.algorithm("Linear", "-initial")
    ops.analyze(4, step / 4)
    ops.analyze(steps, step)
ops.wipe()

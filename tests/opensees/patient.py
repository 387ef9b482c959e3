#!/usr/bin/env python3
"""A mass on an experimental bearing, shaken until the process is killed.

usage: patient.py PORT FILE

Creates the file after a hundred steps.
"""
import sys

import openseespy.opensees as ops

ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.mass(1, 1e6)
ops.element("genericClient", 1, "-node", 1, "-dof", 1, "-server", int(sys.argv[1]), "127.0.0.1")
ops.timeSeries("Trig", 1, 0.0, 1e3, 2.0, "-factor", 3.0)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 0.95)
ops.analysis("Transient")
ops.analyze(100, 0.01)
open(sys.argv[2], "w").close()
while ops.analyze(1, 0.01) == 0:
    pass

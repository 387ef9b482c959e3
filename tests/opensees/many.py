#!/usr/bin/env python3
"""Masses on one spring each: experimental elements, or elements of OpenSees.

usage: many.py FIRST-PORT|inside COUNT STEPS

Mass 1000 kg, springs of 1e5, 2e5, … N/m. Prints the displacements [m] after each step.
"""
import sys

import openseespy.opensees as ops

place, count, steps = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1000, 0.0)
ops.fix(1000, 1)
for i in range(1, count + 1):
    ops.node(i, 0.0)
    ops.mass(i, 1000.0)
    if place == "inside":
        ops.uniaxialMaterial("Elastic", i, 1e5 * i)
        ops.element("zeroLength", i, 1000, i, "-mat", i, "-dir", 1)
    else:
        ops.element("genericClient", i, "-node", i, "-dof", 1, "-server", int(place) + i - 1, "127.0.0.1",
                    *(["-udp"] if i % 2 == 0 else []))
ops.timeSeries("Trig", 1, 0.0, 1e3, 0.5, "-factor", 3.0)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 1.0)
ops.analysis("Transient")
for _ in range(steps):
    ops.analyze(1, 0.01)
    print(*[f"{ops.nodeDisp(i, 1):.12g}" for i in range(1, count + 1)], flush=True)
ops.wipe()

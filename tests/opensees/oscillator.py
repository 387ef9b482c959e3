#!/usr/bin/env python3
"""A mass on an external spring, an `element genericClient`, under a sine excitation.

usage: oscillator.py PORT tcp|udp STEPS INTEGRATOR [ARGUMENT …] [--data-size N]
           [--algorithm NAME[,ARGUMENT …]] [--iterations N]

Mass 0.04, time step 0.02, ground acceleration 100 sin(2 pi t / 0.5). Prints the displacement after each
step. Exits with 3 if a step fails.
"""
import argparse
import sys

import openseespy.opensees as ops

parser = argparse.ArgumentParser()
parser.add_argument("port", type=int)
parser.add_argument("protocol", choices=["tcp", "udp"])
parser.add_argument("steps", type=int)
parser.add_argument("integrator")
parser.add_argument("arguments", type=float, nargs="*")
parser.add_argument("--data-size", type=int)
parser.add_argument("--algorithm", default="Linear")
parser.add_argument("--iterations", type=int)
options = parser.parse_args()

ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.node(2, 0.0)
ops.fix(1, 1)
ops.mass(2, 0.04)
line = ["-server", options.port, "127.0.0.1"]
if options.protocol == "udp":
    line.append("-udp")
if options.data_size:
    line += ["-dataSize", options.data_size]
ops.element("genericClient", 1, "-node", 2, "-dof", 1, *line)
ops.timeSeries("Trig", 1, 0.0, 1e3, 0.5, "-factor", 100.0)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
if options.iterations:
    ops.test("FixedNumIter", options.iterations)
ops.algorithm(*options.algorithm.split(","))
ops.integrator(options.integrator, *options.arguments)
ops.analysis("Transient")
for _ in range(options.steps):
    if ops.analyze(1, 0.02) != 0:
        sys.exit(3)
    print(f"{ops.nodeDisp(2, 1):.9g}", flush=True)
ops.wipe()

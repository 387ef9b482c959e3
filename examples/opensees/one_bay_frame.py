#!/usr/bin/env python3
"""A one-bay frame in kips, inches and seconds, with one of its two columns on a test machine.

usage: one_bay_frame.py MOTION.csv [--column ring|steel] [--port N] [--duration S] [--step S]
           [--integrator NAME [ARGUMENT …]] [--iterations N] [--response FILE]

The motion file has a heading, time [s] in its first column and acceleration [m/s2] in its second. With
`--column ring`, the left column is an external specimen, an `element genericClient`. With `steel`, it is an element
of OpenSees. Writes time and the displacements of both columns' tops [in] at each step.
"""
import argparse
import csv
import sys

import openseespy.opensees as ops

INCH = 0.0254  # [m]
LEFT, RIGHT, LEFT_TOP, RIGHT_TOP = 1, 2, 3, 4
HEIGHT, BAY = 54.0, 100.0  # [in]
MASSES = {LEFT_TOP: 0.04, RIGHT_TOP: 0.02}  # [kip s2/in]
STIFFNESS, STRENGTH, HARDENING = 2.8, 4.2, 0.1  # of the left column [kip/in], [kip], [-]

parser = argparse.ArgumentParser()
parser.add_argument("motion")
parser.add_argument("--column", choices=["ring", "steel"], default="ring")
parser.add_argument("--port", type=int, default=8090)
parser.add_argument("--duration", type=float, default=30)
parser.add_argument("--step", type=float, default=0.01)
parser.add_argument("--integrator", nargs="+", default=["AlphaOS", "0.9"])
parser.add_argument("--iterations", type=int, default=5, help="per step, with an iterating integrator")
parser.add_argument("--response")
options = parser.parse_args()


def value_of(word):
    try:
        return float(word)
    except ValueError:
        return word


ops.model("basic", "-ndm", 2, "-ndf", 2)
for node, x, y in ((LEFT, 0.0, 0.0), (RIGHT, BAY, 0.0), (LEFT_TOP, 0.0, HEIGHT), (RIGHT_TOP, BAY, HEIGHT)):
    ops.node(node, x, y)
for node in (LEFT, RIGHT):
    ops.fix(node, 1, 1)
for node, mass in MASSES.items():
    ops.fix(node, 0, 1)
    ops.mass(node, mass, mass)
ops.uniaxialMaterial("Elastic", 2, 5.6)
ops.element("twoNodeLink", 2, RIGHT, RIGHT_TOP, "-mat", 2, "-dir", 2, "-orient", 0, 1, 0, -1, 0, 0)
ops.uniaxialMaterial("Elastic", 3, 2.0 * BAY / 1.0)  # the beam: 2 kip/in along its axis
ops.element("truss", 3, LEFT_TOP, RIGHT_TOP, 1.0, 3)
if options.column == "ring":
    ops.element("genericClient", 1, "-node", LEFT_TOP, "-dof", 1, "-server", options.port, "127.0.0.1")
else:
    ops.uniaxialMaterial("Steel01", 1, STRENGTH, STIFFNESS, HARDENING)
    ops.element("twoNodeLink", 1, LEFT, LEFT_TOP, "-mat", 1, "-dir", 2, "-orient", 0, 1, 0, -1, 0, 0)

with open(options.motion, newline="") as file:
    rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
ops.timeSeries("Path", 1, "-dt", rows[1][0] - rows[0][0], "-values", *[row[1] for row in rows], "-factor", 1 / INCH)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.rayleigh(0.4, 0.0, 0.0, 0.0)  # about 2 % of the first mode
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
if "HS" in options.integrator[0]:  # iterating: each iteration moves the specimen
    ops.test("FixedNumIter", options.iterations)
    ops.algorithm("Newton", "-initial")
else:
    ops.algorithm("Linear", "-initial")
ops.integrator(*[value_of(word) for word in options.integrator])
ops.analysis("Transient")
response = open(options.response, "w") if options.response else None
for number in range(round(options.duration / options.step)):
    if ops.analyze(1, options.step) != 0:
        sys.exit(f"the analysis failed at {number * options.step:.2f} s")
    if response:
        print(ops.getTime(), ops.nodeDisp(LEFT_TOP, 1), ops.nodeDisp(RIGHT_TOP, 1), sep=",", file=response)
ops.wipe()

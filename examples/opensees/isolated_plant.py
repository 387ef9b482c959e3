#!/usr/bin/env python3
"""A seismically isolated plant in OpenSees, divided by its 486 bearings: the share of one bearing.

usage: isolated_plant.py MOTION.csv [--columns X Y] [--unit F] [--bearing ring|plasticity|bouc_wen] [--port N] [--udp]
           [--duration S] [--step S] [--integrator NAME [ARGUMENT …]] [--response FILE]

The motion file has a heading, time [s] in its first column, and acceleration [F m/s2] in columns X and Y, counted
from 0. Defaults: X 1, Y 2, F 1. Three buildings are sticks of masses on a rigid mat. With `--bearing ring`, the
bearing is an external specimen, an `element genericClient`; a script needs no other change. The other choices are
elements of OpenSees. Writes time, displacement of the mat [m] and its absolute acceleration [m/s2], x and y, at each
step.
"""
import argparse
import csv
import math
import sys

import openseespy.opensees as ops

BEARINGS = 486
MAT = 145e6  # [kg]
STICKS = [  # masses [kg], first fixed-base frequency along x and y [Hz]
    ([16e6, 16e6, 16e6, 14e6, 10e6], 4.4, 4.6),
    ([22e6, 20e6, 18e6, 12e6], 5.9, 6.3),
    ([60e6, 50e6, 45e6, 36e6], 7.6, 7.6),
]
DAMPING = 0.04  # of the first mode of a stick
STRENGTH, STIFFNESS, YIELD = 1.01e6, 4.238e6, 2.855e-3  # of a bearing [N], [N/m], [m]
GROUND, BASE = 1, 2

parser = argparse.ArgumentParser()
parser.add_argument("motion")
parser.add_argument("--columns", type=int, nargs=2, default=[1, 2])
parser.add_argument("--unit", type=float, default=1.0)
parser.add_argument("--bearing", choices=["ring", "plasticity", "bouc_wen"], default="ring")
parser.add_argument("--port", type=int, default=8090)
parser.add_argument("--udp", action="store_true")
parser.add_argument("--duration", type=float, default=30)
parser.add_argument("--step", type=float, default=0.01)
parser.add_argument("--integrator", nargs="+", default=["AlphaOS", "0.95"])
parser.add_argument("--iterations", type=int, default=5, help="per step, with an iterating integrator")
parser.add_argument("--response")
options = parser.parse_args()


def storey_stiffness(masses, frequency):
    """The storey stiffness, equal for all storeys, that gives the frequency of the first mode (inverse iteration)."""
    shape = [1.0] * len(masses)
    for _ in range(100):
        forces = [mass * x for mass, x in zip(masses, shape)]
        shears = [sum(forces[i:]) for i in range(len(masses))]
        sway = [sum(shears[: i + 1]) for i in range(len(masses))]  # of storeys of stiffness 1
        eigenvalue = shape[-1] / sway[-1]
        shape = [x / sway[-1] for x in sway]
    return (2 * math.pi * frequency) ** 2 / eigenvalue


def add_stick(first, masses, frequency_x, frequency_y):
    below = BASE
    for i, mass in enumerate(masses):
        node = first + i
        ops.node(node, 0.0, 0.0, 0.0)
        ops.fix(node, 0, 0, 1, 1, 1, 1)
        ops.mass(node, mass / BEARINGS, mass / BEARINGS, 0, 0, 0, 0)
        for direction, frequency in ((1, frequency_x), (2, frequency_y)):
            tag = 10 * node + direction
            stiffness = storey_stiffness(masses, frequency) / BEARINGS
            ops.uniaxialMaterial("Elastic", tag, stiffness,
                                 stiffness * DAMPING / (math.pi * frequency))
            ops.element("zeroLength", tag, below, node, "-mat", tag, "-dir", direction)
        below = node


def add_bearing():
    if options.bearing == "ring":
        ops.element("genericClient", 1, "-node", BASE, "-dof", 1, 2, "-server", options.port, "127.0.0.1",
                    *(["-udp"] if options.udp else []), "-noRayleigh")
        return
    initial = STIFFNESS + STRENGTH / YIELD
    ops.uniaxialMaterial("Elastic", 1, 1e10)
    kind, knee = {"plasticity": ("elastomericBearingPlasticity", []),
                  "bouc_wen": ("elastomericBearingBoucWen", [2.0, 0.5, 0.5])}[options.bearing]
    ops.element(kind, 1, GROUND, BASE, initial, STRENGTH, STIFFNESS / initial, 0.0, 1.0, *knee,
                "-P", 1, "-T", 1, "-My", 1, "-Mz", 1, "-orient", 0, 0, 1, 1, 0, 0)


def shake():
    with open(options.motion, newline="") as file:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    interval = rows[1][0] - rows[0][0]
    for direction, column in enumerate(options.columns, start=1):
        ops.timeSeries("Path", direction, "-dt", interval, "-values", *[row[column] for row in rows], "-factor",
                       options.unit)
        ops.pattern("UniformExcitation", direction, direction, "-accel", direction)


def value_of(word):
    try:
        return float(word)
    except ValueError:
        return word


ops.model("basic", "-ndm", 3, "-ndf", 6)
ops.node(GROUND, 0.0, 0.0, 0.0)
ops.fix(GROUND, 1, 1, 1, 1, 1, 1)
ops.node(BASE, 0.0, 0.0, 0.0)
ops.fix(BASE, 0, 0, 1, 1, 1, 1)
ops.mass(BASE, MAT / BEARINGS, MAT / BEARINGS, 0, 0, 0, 0)
for number, stick in enumerate(STICKS):
    add_stick(10 * (number + 1), *stick)
add_bearing()
shake()
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
        print(ops.getTime(), *ops.nodeDisp(BASE)[:2], *ops.nodeAccel(BASE)[:2], sep=",", file=response)
ops.wipe()

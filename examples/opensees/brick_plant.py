#!/usr/bin/env python3
"""A small isolated plant of bricks on 15 bearings in OpenSees, on any number of processors.

usage: brick_plant.py MOTION.csv [--columns X Y] [--bearing ring|bilinear] [--port N] [--duration S] [--step S]
           [--response FILE]
       mpiexec.mpich -n N python3 brick_plant.py …, or processes = N in the table of the node

The motion file has a heading, time [s] in its first column, and acceleration [m/s2] in columns X and Y, counted from 0.
Each rank builds a slice of the plant: its bricks, and the nodes of these. A node on a cut is on both ranks; its mass and
its bearing are on the first. The tested bearing, at the corner, is an `element genericClient` on rank 0 with
`--bearing ring`. Rank 0 writes time and displacement of the node above it [m], x and y, at each step.
"""
import argparse
import csv
import math
import sys

import openseespy.opensees as ops

COLUMNS, ROWS, SIDE = 8, 4, 5.0  # bricks along x and y, and their sides [m]
HEIGHTS = [2.0, 5.0, 5.0, 5.0]  # of the layers; the first is the mat [m]
MODULI = [30e9] + 3 * [0.25e9]  # of the layers: first frequencies near 5 Hz on a fixed base [Pa]
BEARING_MASS = 988e3  # on each bearing [kg]
STRENGTH, STIFFNESS, YIELD = 1.01e6, 4.238e6, 2.855e-3  # of a bearing [N], [N/m], [m]
AXIAL_STIFFNESS = 8e9  # of a bearing [N/m]
DAMPING = 0.02 / (math.pi * 5)  # proportional to the stiffness of the bricks: 2 % at 5 Hz [s]

parser = argparse.ArgumentParser()
parser.add_argument("motion")
parser.add_argument("--columns", type=int, nargs=2, default=[1, 2])
parser.add_argument("--bearing", choices=["ring", "bilinear"], default="ring")
parser.add_argument("--port", type=int, default=8090)
parser.add_argument("--duration", type=float, default=20)
parser.add_argument("--step", type=float, default=0.002)
parser.add_argument("--response")
options = parser.parse_args()

ranks, rank = ops.getNP(), ops.getPID()


def tag_of(i, j, k):
    """Node i along x, j along y and k upwards."""
    return 1 + i + (COLUMNS + 1) * (j + (ROWS + 1) * k)


TESTED = tag_of(0, 0, 0)
BRICKS = COLUMNS * ROWS * len(HEIGHTS)
NODES = (COLUMNS + 1) * (ROWS + 1) * (len(HEIGHTS) + 1)


def rank_of_bricks(i):
    return i * ranks // COLUMNS


def rank_of_node(i):
    """The first of its ranks."""
    return rank_of_bricks(max(i - 1, 0))


def columns_of_nodes():
    return [i for i in range(COLUMNS + 1)
            if rank in (rank_of_bricks(max(i - 1, 0)), rank_of_bricks(min(i, COLUMNS - 1)))]


def add_nodes():
    bearings = (COLUMNS // 2 + 1) * (ROWS // 2 + 1)
    density = BEARING_MASS * bearings / (COLUMNS * ROWS * SIDE * SIDE * sum(HEIGHTS))
    for i in columns_of_nodes():
        for j in range(ROWS + 1):
            area = SIDE * SIDE * (0.5 if i in (0, COLUMNS) else 1) * (0.5 if j in (0, ROWS) else 1)
            for k in range(len(HEIGHTS) + 1):
                ops.node(tag_of(i, j, k), SIDE * i, SIDE * j, sum(HEIGHTS[:k]))
                if rank_of_node(i) == rank:
                    mass = density * area * sum(HEIGHTS[max(k - 1, 0):k + 1]) / 2
                    ops.mass(tag_of(i, j, k), mass, mass, mass)


def add_bricks():
    for layer, modulus in enumerate(MODULI):
        ops.nDMaterial("ElasticIsotropic", layer + 1, modulus, 0.2)
    own = []
    for number in range(BRICKS):
        i, j, k = number % COLUMNS, number // COLUMNS % ROWS, number // (COLUMNS * ROWS)
        if rank_of_bricks(i) == rank:
            below = [tag_of(i, j, k), tag_of(i + 1, j, k), tag_of(i + 1, j + 1, k), tag_of(i, j + 1, k)]
            level = tag_of(0, 0, 1) - tag_of(0, 0, 0)
            ops.element("stdBrick", number + 1, *below, *(node + level for node in below), k + 1)
            own.append(number + 1)
    ops.region(1, "-ele", *own, "-rayleigh", 0.0, 0.0, DAMPING, 0.0)


def add_bearings():
    initial = STIFFNESS + STRENGTH / YIELD
    ops.uniaxialMaterial("Steel01", 1, initial * YIELD, initial, STIFFNESS / initial)
    ops.uniaxialMaterial("Elastic", 2, AXIAL_STIFFNESS)
    for i in range(0, COLUMNS + 1, 2):
        for j in range(0, ROWS + 1, 2):
            if rank_of_node(i) != rank:
                continue
            node = tag_of(i, j, 0)
            ground = NODES + node
            ops.node(ground, *ops.nodeCoord(node))
            ops.fix(ground, 1, 1, 1)
            if node == TESTED and options.bearing == "ring":
                ops.element("zeroLength", BRICKS + node, ground, node, "-mat", 2, "-dir", 3)
                ops.element("genericClient", BRICKS + NODES + 1, "-node", node, "-dof", 1, 2,
                            "-server", options.port, "127.0.0.1", "-noRayleigh")
            else:
                ops.element("zeroLength", BRICKS + node, ground, node, "-mat", 1, 1, 2, "-dir", 1, 2, 3)


def shake():
    with open(options.motion, newline="") as file:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    interval = rows[1][0] - rows[0][0]
    for direction, column in enumerate(options.columns, start=1):
        ops.timeSeries("Path", direction, "-dt", interval, "-values", *[row[column] for row in rows])
        ops.pattern("UniformExcitation", direction, direction, "-accel", direction)


ops.model("basic", "-ndm", 3, "-ndf", 3)
add_nodes()
add_bricks()
add_bearings()
shake()
ops.constraints("Plain")
ops.numberer("ParallelPlain" if ranks > 1 else "RCM")
ops.system("Mumps")
ops.algorithm("Linear", "-initial", "-factorOnce")
ops.integrator("AlphaOS", 0.95)
ops.analysis("Transient")
response = open(options.response, "w") if options.response and rank == 0 else None
for number in range(round(options.duration / options.step)):
    if ops.analyze(1, options.step) != 0:
        sys.exit(f"the analysis failed at {number * options.step:.2f} s")
    if response:
        print(ops.getTime(), *ops.nodeDisp(TESTED)[:2], sep=",", file=response)
ops.wipe()

#!/usr/bin/env python3
"""Structures on one isolation bearing, which is an external specimen.

usage: structures.py STRUCTURE MOTION.csv PORT STEP DURATION

frame: three storeys of 2.2 Hz; stick: one mass of 8 Hz; braced: two storeys of 4 Hz whose braces yield. All carry
9.7 MN. The motion file has a heading, time [s], and accelerations x and y [m/s2].
"""
import csv
import math
import sys

import openseespy.opensees as ops

STRUCTURES = {  # masses from the base upwards [kg], stiffness of a storey [N/m], strength of its braces [N]
    "frame": ([300e3, 230e3, 230e3, 227e3], 2.2, None),
    "stick": ([500e3, 487e3], 8.0, None),
    "braced": ([400e3, 300e3, 287e3], 4.0, 1.2e6),
}
DAMPING = 0.02  # of the first mode of the fixed base
structure, motion, port, step, duration = sys.argv[1], sys.argv[2], int(sys.argv[3]), *map(float, sys.argv[4:6])
masses, frequency, strength = STRUCTURES[structure]


def storey_stiffness():
    """Equal for all storeys: first mode of the fixed base by inverse iteration."""
    above, shape = masses[1:], [1.0] * (len(masses) - 1)
    for _ in range(100):
        forces = [mass * x for mass, x in zip(above, shape)]
        shears = [sum(forces[i:]) for i in range(len(forces))]
        sway = [sum(shears[:i + 1]) for i in range(len(shears))]
        eigenvalue, shape = shape[-1] / sway[-1], [x / sway[-1] for x in sway]
    return (2 * math.pi * frequency) ** 2 / eigenvalue


ops.model("basic", "-ndm", 2, "-ndf", 2)
stiffness = storey_stiffness()
for floor, mass in enumerate(masses, start=1):
    ops.node(floor, 0.0, 0.0)
    ops.mass(floor, mass, mass)
    if floor == 1:
        continue
    damping = stiffness * DAMPING / (math.pi * frequency)
    for direction in (1, 2):
        tag = 10 * floor + direction
        if strength is None:
            ops.uniaxialMaterial("Elastic", tag, stiffness, damping)
        else:
            ops.uniaxialMaterial("Steel01", 100 + tag, strength, stiffness, 0.1)
            ops.uniaxialMaterial("Elastic", 200 + tag, 0.0, damping)
            ops.uniaxialMaterial("Parallel", tag, 100 + tag, 200 + tag)
        ops.element("zeroLength", tag, floor - 1, floor, "-mat", tag, "-dir", direction)
ops.element("genericClient", 1, "-node", 1, "-dof", 1, 2, "-server", port, "127.0.0.1", "-noRayleigh")
with open(motion, newline="") as file:
    rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
for direction in (1, 2):
    ops.timeSeries("Path", direction, "-dt", rows[1][0] - rows[0][0], "-values", *[row[direction] for row in rows])
    ops.pattern("UniformExcitation", direction, direction, "-accel", direction)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 0.95)
ops.analysis("Transient")
for number in range(round(duration / step)):
    if ops.analyze(1, step) != 0:
        sys.exit(f"the analysis failed at {number * step:.2f} s")
ops.wipe()

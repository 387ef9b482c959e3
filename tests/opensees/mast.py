#!/usr/bin/env python3
"""A mast on one bearing with shear, rotation and axial load: an experimental element, or one of OpenSees.

usage: mast.py MOTION.csv ring|own PORT RESPONSE.csv [--both-nodes]

The bearing is 0.5 m high, with the point of zero moment 0.15 m above the foundation. The mast is 6 m of steel with
450 t. The weight is applied first. Writes time and the six displacements of the top of the bearing at each step.
With `--both-nodes`, the element also lists the foundation's degrees of freedom.
"""
import csv
import sys

import openseespy.opensees as ops

motion, place, port, response = sys.argv[1:5]
both = "--both-nodes" in sys.argv
FOUNDATION, BEARING, TOP = 1, 2, 3
MASS, HEIGHT = 450e3, 6.0
STRENGTH, STIFFNESS, YIELD = 1.01e6, 4.238e6, 2.855e-3
SPRINGS = {"-P": 3e9, "-T": 2e7, "-My": 4e8, "-Mz": 5e8}  # [N/m], [N m/rad]

ops.model("basic", "-ndm", 3, "-ndf", 6)
ops.node(FOUNDATION, 0.0, 0.0, 0.0)
ops.fix(FOUNDATION, 1, 1, 1, 1, 1, 1)
ops.node(BEARING, 0.0, 0.0, 0.5)
ops.node(TOP, 0.0, 0.0, 0.5 + HEIGHT)
ops.mass(BEARING, 20e3, 20e3, 20e3, 4e3, 4e3, 4e3)
ops.mass(TOP, MASS, MASS, MASS, 6e5, 6e5, 6e5)
ops.geomTransf("Linear", 1, 1.0, 0.0, 0.0)
ops.element("elasticBeamColumn", 1, BEARING, TOP, 0.5, 2e11, 8e10, 0.4, 0.2, 0.2, 1)
if place == "ring":
    nodes = ["-node", FOUNDATION, BEARING, "-dof", *range(1, 7), "-dof", *range(1, 7)] if both else \
        ["-node", BEARING, "-dof", *range(1, 7)]
    ops.element("genericClient", 2, *nodes, "-server", int(port), "127.0.0.1", "-noRayleigh")
else:
    initial = STIFFNESS + STRENGTH / YIELD
    materials = []
    for tag, (flag, stiffness) in enumerate(SPRINGS.items(), start=1):
        ops.uniaxialMaterial("Elastic", tag, stiffness)
        materials += [flag, tag]
    ops.element("elastomericBearingPlasticity", 2, FOUNDATION, BEARING, initial, STRENGTH, STIFFNESS / initial, 0.0,
                1.0, *materials, "-orient", 0, 0, 1, 1, 0, 0, "-shearDist", 0.3)

ops.timeSeries("Linear", 3)
ops.pattern("Plain", 3, 3)
ops.load(TOP, 0, 0, -9.81 * MASS, 0, 0, 0)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear")
ops.integrator("LoadControl", 1.0)
ops.analysis("Static")
ops.analyze(1)
ops.loadConst("-time", 0.0)

with open(motion, newline="") as file:
    rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
for direction in (1, 2):
    ops.timeSeries("Path", direction, "-dt", rows[1][0] - rows[0][0], "-values", *[row[direction] for row in rows])
    ops.pattern("UniformExcitation", direction, direction, "-accel", direction)
ops.wipeAnalysis()
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.algorithm("Linear", "-initial")
ops.integrator("AlphaOS", 0.9)
ops.analysis("Transient")
with open(response, "w") as file:
    for _ in range(1000):
        if ops.analyze(1, 0.01) != 0:
            sys.exit("the analysis failed")
        print(ops.getTime(), *[f"{u:.9g}" for u in ops.nodeDisp(BEARING)], sep=",", file=file)
ops.wipe()

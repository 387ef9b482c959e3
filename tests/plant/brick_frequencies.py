# SPDX-License-Identifier: Apache-2.0
"""Frequencies of a plant of OpenSees' stdBrick on zeroLength springs.

brick_frequencies.py FOLDER COUNT: reads nodes.csv (x, y, z, mass), solids.csv (eight nodes, part),
moduli.csv (modulus, Poisson ratio) and springs.csv (node, long, lat, up); writes frequencies.csv [Hz].
"""
import csv
import math
import pathlib
import sys

import openseespy.opensees as ops


def rows(folder, name):
    with open(folder / name, newline="") as file:
        return [[float(cell) for cell in row] for row in csv.reader(file)]


def build(folder):
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    nodes = rows(folder, "nodes.csv")
    for tag, (x, y, z, mass) in enumerate(nodes, 1):
        ops.node(tag, x, y, z)
        ops.mass(tag, mass, mass, mass)
    for tag, (modulus, poisson_ratio) in enumerate(rows(folder, "moduli.csv"), 1):
        ops.nDMaterial("ElasticIsotropic", tag, modulus, poisson_ratio, 0.0)
    solids = rows(folder, "solids.csv")
    for tag, solid in enumerate(solids, 1):
        ops.element("stdBrick", tag, *(int(node) + 1 for node in solid[:8]), int(solid[8]) + 1)
    materials = {}
    for i, (node, *springs) in enumerate(rows(folder, "springs.csv"), 1):
        for stiffness in springs:
            if stiffness not in materials:
                materials[stiffness] = len(materials) + 1
                ops.uniaxialMaterial("Elastic", materials[stiffness], stiffness)
        ground = len(nodes) + i
        ops.node(ground, *nodes[int(node)][:3])
        ops.fix(ground, 1, 1, 1)
        ops.element("zeroLength", len(solids) + i, ground, int(node) + 1,
                    "-mat", *(materials[stiffness] for stiffness in springs), "-dir", 1, 2, 3)


def main():
    folder = pathlib.Path(sys.argv[1])
    build(folder)
    ops.constraints("Plain")
    ops.numberer("RCM")
    values = ops.eigen(int(sys.argv[2]))
    frequencies = [math.sqrt(value) / (2 * math.pi) for value in values]
    (folder / "frequencies.csv").write_text("".join(f"{f!r}\n" for f in frequencies))


main()

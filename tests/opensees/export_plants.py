#!/usr/bin/env python3
"""Writes a model as the files of a plant, and its frequencies with the bearings' springs.

usage: export_plants.py TREE FOLDER bricks|frame|inches|diaphragm|held|coupled [COUNT]

`bricks` reads the tables of solid_plant.py from FOLDER. Writes FOLDER/plant and FOLDER/frequencies.csv [Hz].
"""
import math
import pathlib
import sys

tree, folder, model = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
sys.path[:0] = [str(tree / "examples/opensees"), str(tree / "benchmarks/solver/solids")]
import openseespy.opensees as ops

import plant_files
import solid_plant

INCH, KIP = 0.0254, 4448.2216


def frequencies():
    values = ops.eigen(int(sys.argv[4]))
    (folder / "frequencies.csv").write_text("".join(f"{math.sqrt(value) / (2 * math.pi)!r}\n" for value in values))


def bricks():
    solids = solid_plant.build(folder, solid_plant.Springs())
    frequencies()
    nodes = [int(row[0]) + 1 for row in solid_plant.rows(folder, "springs.csv")]
    return dict(bearings=nodes, floors={"top": 1}, without=range(solids + 1, solids + 1 + len(nodes)))


def frame(length=1.0, force=1.0):
    """Two bays by one, two storeys; the lower floor is a rigid diaphragm. Beams and columns have rotations without mass."""
    unit = force / length  # of a stiffness
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    tag = lambda i, j, k: 1 + i + 3 * j + 10 * k
    places = [(i, j) for i in range(3) for j in range(2)]
    for k in range(3):
        for i, j in places:
            ops.node(tag(i, j, k), 6.0 * i / length, 5.0 * j / length, 3.5 * k / length)
            mass = 20e3 * (1 + 0.1 * i) / unit
            ops.mass(tag(i, j, k), *([mass] * 3 if k != 1 else [0, 0, mass]), 0, 0, 0)
    ops.geomTransf("Linear", 1, 1, 0, 0)
    ops.geomTransf("Linear", 2, 0, 0, 1)
    section = 0.09 / length**2, 30e9 / (force / length**2), 12e9 / (force / length**2), *(x / length**4 for x in (1.2e-3, 7e-4, 6e-4))
    pairs = [(tag(i, j, k), tag(i, j, k + 1), 1) for k in range(2) for i, j in places]
    pairs += [(tag(i, j, k), tag(i + 1, j, k), 2) for k in range(3) for i in range(2) for j in range(2)]
    pairs += [(tag(i, 0, k), tag(i, 1, k), 2) for k in range(3) for i in range(3)]
    for number, (one, other, transf) in enumerate(pairs, 1):
        ops.element("elasticBeamColumn", number, one, other, *section, transf)
    ops.node(99, 6.5 / length, 2.5 / length, 3.5 / length)
    ops.fix(99, 0, 0, 1, 1, 1, 0)
    ops.mass(99, 150e3 / unit, 150e3 / unit, 0, 0, 0, 2e6 / unit / length**2)
    ops.rigidDiaphragm(3, 99, *(tag(i, j, 1) for i, j in places))
    for material, stiffness in enumerate((2e7, 8e9), 1):
        ops.uniaxialMaterial("Elastic", material, stiffness / unit)
    bearings = [tag(i, j, 0) for i, j in places]
    for node in bearings:
        ops.node(1000 + node, *ops.nodeCoord(node))
        ops.fix(1000 + node, 1, 1, 1, 1, 1, 1)
        ops.element("zeroLength", 1000 + node, 1000 + node, node, "-mat", 1, 1, 2, "-dir", 1, 2, 3)
    return dict(bearings=bearings, floors={"roof": tag(0, 0, 2)}, without=[1000 + node for node in bearings],
                length_unit_m=length, force_unit_N=force)


settings = bricks() if model == "bricks" else frame(*([INCH, KIP] if model == "inches" else []))
if model in ("frame", "inches"):
    ops.constraints("Transformation")
    frequencies()
elif model == "diaphragm":
    settings["floors"] = {"lower": 11}
elif model == "held":
    settings["without"] = settings["without"][1:]
elif model == "coupled":
    ops.mass(11, 1e4, 1e4, 1e4, 0, 0, 0)
try:
    print(*plant_files.write(folder / "plant", **settings))
except ValueError as error:
    sys.exit(str(error))

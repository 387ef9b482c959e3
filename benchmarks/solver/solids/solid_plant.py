# SPDX-License-Identifier: Apache-2.0
"""A plant of OpenSees' stdBrick on bearings: its frequencies, or the time of its steps.

solid_plant.py FOLDER frequencies COUNT
solid_plant.py FOLDER steps COUNT STEP_S

The folder has nodes.csv (x, y, z, mass), solids.csv (eight nodes, part), moduli.csv (modulus, Poisson ratio) and
springs.csv (node, initial stiffness long, lat, up). `frequencies` writes frequencies.csv [Hz]. `steps` also reads
bearings.csv (post-yield stiffness, strength: bilinear along each axis), damping.csv (proportional to the stiffness of the
solids [s]) and motion.csv (time [s], accelerations long, lat, up [m/s2]). Its last line is a JSON object with the wall and
processor time of each step [s], and the memory of the process [B].
"""
import csv
import json
import math
import pathlib
import resource
import sys
import time

import openseespy.opensees as ops


def rows(folder, name):
    with open(folder / name, newline="") as file:
        return [[float(cell) for cell in row] for row in csv.reader(file)]


class Springs:
    """Materials by their stiffness, each made once."""

    def __init__(self, bearing=None):
        self.bearing, self.tags = bearing, {}

    def tag(self, stiffness, direction):
        key = stiffness, direction == 3
        if key not in self.tags:
            self.tags[key] = len(self.tags) + 1
            self.make(*key)
        return self.tags[key]

    def make(self, stiffness, is_vertical):
        tag = self.tags[stiffness, is_vertical]
        if self.bearing is None or is_vertical:
            ops.uniaxialMaterial("Elastic", tag, stiffness)
            return
        post_yield, strength = self.bearing
        ops.uniaxialMaterial("Steel01", tag, strength / (1 - post_yield / stiffness), stiffness, post_yield / stiffness)


def build(folder, springs):
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
    for i, (node, *stiffnesses) in enumerate(rows(folder, "springs.csv"), 1):
        ground = len(nodes) + i
        ops.node(ground, *nodes[int(node)][:3])
        ops.fix(ground, 1, 1, 1)
        materials = [springs.tag(stiffness, direction) for direction, stiffness in enumerate(stiffnesses, 1)]
        ops.element("zeroLength", len(solids) + i, ground, int(node) + 1, "-mat", *materials, "-dir", 1, 2, 3)
    ops.constraints("Plain")
    ops.numberer("RCM")
    return len(solids)


def frequencies(folder, count):
    build(folder, Springs())
    values = ops.eigen(count)
    (folder / "frequencies.csv").write_text("".join(f"{math.sqrt(value) / (2 * math.pi)!r}\n" for value in values))


def shake(folder):
    motion = rows(folder, "motion.csv")
    for direction in (1, 2, 3):
        ops.timeSeries("Path", direction, "-dt", motion[1][0] - motion[0][0], "-values", *(row[direction] for row in motion))
        ops.pattern("UniformExcitation", direction, direction, "-accel", direction)


def steps(folder, count, step):
    [bearing], [[damping]] = rows(folder, "bearings.csv"), rows(folder, "damping.csv")
    solids = build(folder, Springs(bearing))
    ops.region(1, "-eleRange", 1, solids, "-rayleigh", 0.0, 0.0, damping, 0.0)
    shake(folder)
    # The fastest of its combinations for this plant: one factor, no iteration.
    ops.system("Mumps")
    ops.integrator("AlphaOS", 0.95)
    ops.algorithm("Linear", "-initial", "-factorOnce")
    ops.analysis("Transient")
    times = []
    for _ in range(count + 1):
        begun = time.perf_counter(), time.process_time()
        if ops.analyze(1, step) != 0:
            sys.exit("the analysis failed")
        times.append((time.perf_counter() - begun[0], time.process_time() - begun[1]))
    wall, processor = zip(*times[1:])  # without the step of the factorisation
    memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"version": ops.version(), "wall": wall, "processor": processor, "memory": memory}), flush=True)


def main():
    folder, task, count = pathlib.Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    if task == "frequencies":
        frequencies(folder, count)
    else:
        steps(folder, count, float(sys.argv[4]))


if __name__ == "__main__":
    main()

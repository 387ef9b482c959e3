#!/usr/bin/env python3
"""Moves one bearing element of OpenSees along a given motion and writes its resisting forces.

usage: bearing.py CASE.json

The case is an object:
  element          its name and its arguments after the two nodes
  materials        uniaxial materials, each a list: name, tag, arguments     (optional)
  friction_models  friction models, each a list: name, tag, arguments        (optional)
  time_step_s      of the analysis
  motion           CSV without a header, a row for each step from time 0:
                   displacements long, lat, vert [m], velocities long, lat, vert [m/s]
  forces           CSV to write, a row for each step from the first: long, lat, axial [N];
                   axial < 0 compresses; empty: none
  copies           number of such elements between the two nodes             (optional, 1)

The element is along the global z axis; long is x and lat is y. Its lower node is fixed. The upper
one follows the motion, displacements and velocities, and does not rotate. A separate spring gives
the solver the one degree of freedom that it needs.

The last line of the output is {"steps": …, "seconds": …, "version": …}, with the processor time of
the analysis. A case without forces records nothing while it is timed.
"""
import json
import pathlib
import sys
import time

FIXED = (1, 1, 1, 1, 1, 1)
AXES = range(3)
HEIGHT = 0.3  # [m]; has no effect without rotation


def read_motion(file):
    rows = [[float(word) for word in line.split(",")] for line in open(file)]
    return list(zip(*rows))


def make_model(ops, case):
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node in (1, 2, 3, 4):
        ops.node(node, 0.0, 0.0, HEIGHT if node == 2 else 0.0)
    ops.fix(1, *FIXED)
    ops.fix(2, 0, 0, 0, 1, 1, 1)
    ops.fix(3, *FIXED)
    ops.fix(4, 0, 1, 1, 1, 1, 1)
    ops.mass(4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ops.uniaxialMaterial("Elastic", 10_000, 1.0)
    ops.element("zeroLength", 10_000, 3, 4, "-mat", 10_000, "-dir", 1)
    for material in case.get("materials", []):
        ops.uniaxialMaterial(*material)
    for model in case.get("friction_models", []):
        ops.frictionModel(*model)
    name, *arguments = case["element"]
    for copy in range(case.get("copies", 1)):
        ops.element(name, copy + 1, 1, 2, *arguments)


def impose(ops, motion, step):
    """Imposes displacement and velocity on node 2. OpenSees does not derive the velocity: it would stay 0."""
    ops.pattern("MultipleSupport", 1)
    for axis in AXES:
        for first_tag, column in ((10, axis), (20, axis + 3)):
            ops.timeSeries("Path", first_tag + axis, "-dt", step, "-values", *motion[column],
                           "-useLast")  # rounding may put the last time behind the end
        ops.timeSeries("Constant", 30 + axis, "-factor", 0.0)
        ops.groundMotion(axis + 1, "Plain", "-disp", 10 + axis, "-vel", 20 + axis,
                         "-accel", 30 + axis)
        ops.imposedMotion(2, axis + 1, axis + 1)


def prepare_analysis(ops):
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("FixedNumIter", 1)
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")


def upper_node_forces(file):
    """The three forces on the upper node, from a recorder's file."""
    return [",".join(line.split()[6:9]) for line in open(file)]


def main():
    import openseespy.opensees as ops
    case = json.load(open(sys.argv[1]))
    motion = read_motion(case["motion"])
    step, steps = case["time_step_s"], len(motion[0]) - 1
    make_model(ops, case)
    impose(ops, motion, step)
    prepare_analysis(ops)
    forces = case.get("forces")
    if forces:
        ops.recorder("Element", "-file", forces + ".recorder", "-precision", 12, "-ele", 1, "force")
    begun = time.process_time()
    status = ops.analyze(steps, step)
    seconds = time.process_time() - begun
    reached = round(ops.getTime() / step)
    version = ops.version()
    ops.wipe()  # closes the recorder's file
    if status != 0:
        sys.exit(f"the analysis failed in step {reached + 1} of {steps}")
    if forces:
        pathlib.Path(forces).write_text("\n".join(upper_node_forces(forces + ".recorder")) + "\n")
    sys.stdout.flush()
    print("\n" + json.dumps({"steps": steps, "seconds": seconds, "version": version}), flush=True)


main()

# SPDX-License-Identifier: Apache-2.0
"""The simulations of users, as their files: scripts of OpenSees, and the description of an FMU."""

_FRAME = '''"""An isolated frame under a ground acceleration: frame.py GROUND STEP k1 c1 k2 c2 …"""
import sys

import openseespy.opensees as ops

masses = MASSES
ground, step, *values = sys.argv[1:]
step, values = float(step), [float(value) for value in values]

ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.fix(1, 1)
for i, mass in enumerate(masses):
    ops.node(i + 2, 0.0)
    ops.mass(i + 2, mass)
    ops.uniaxialMaterial("Elastic", 2 * i + 1, values[2 * i])
    ops.uniaxialMaterial("Viscous", 2 * i + 2, values[2 * i + 1], 1.0)
    ops.element("zeroLength", 2 * i + 1, i + 1, i + 2, "-mat", 2 * i + 1, "-dir", 1)
    ops.element("zeroLength", 2 * i + 2, i + 1, i + 2, "-mat", 2 * i + 2, "-dir", 1)
ops.timeSeries("Path", 1, "-dt", step, "-filePath", ground, "-useLast")
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.recorder("Node", "-file", "floors.out", "-time", "-precision", 12, "-node", *range(2, len(masses) + 2), "-dof", 1, "disp")
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormUnbalance", 1e-6 * masses[0], 50)
ops.algorithm("Newton")
ops.integrator("Newmark", 0.5, 0.25)
ops.analysis("Transient")
with open(ground) as file:
    steps = sum(1 for _ in file) - 1
if ops.analyze(steps, step) != 0:
    sys.exit("the analysis failed")
ops.wipe()
'''

_SLIDER = '''"""A slider along a prescribed motion: slider.py MOTION STEP mu k [R]"""
import sys

import openseespy.opensees as ops

motion, step, *values = sys.argv[1:]
step, (mu, k, *radius) = float(step), [float(value) for value in values]
with open(motion) as file:
    u = [float(line) for line in file]
last = len(u) - 1
v = [(u[min(i + 1, last)] - u[max(i - 1, 0)]) / (step * (min(i + 1, last) - max(i - 1, 0))) for i in range(len(u))]

ops.model("basic", "-ndm", 3, "-ndf", 6)
for node in (1, 2, 3, 4):
    ops.node(node, 0.0, 0.0, 0.0)
ops.fix(1, 1, 1, 1, 1, 1, 1)
ops.fix(2, 0, 0, 0, 1, 1, 1)
ops.fix(3, 1, 1, 1, 1, 1, 1)
ops.fix(4, 0, 1, 1, 1, 1, 1)
ops.mass(4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ops.uniaxialMaterial("Elastic", 9, 1.0)
ops.element("zeroLength", 9, 3, 4, "-mat", 9, "-dir", 1)
ops.uniaxialMaterial("Elastic", 1, 5e9)
ops.uniaxialMaterial("Elastic", 2, 1e6)
ops.frictionModel("Coulomb", 1, mu)
bearing = ["singleFPBearing", 1, 1, 2, 1, radius[0]] if radius else ["flatSliderBearing", 1, 1, 2, 1]
ops.element(*bearing, k, "-P", 1, "-T", 2, "-My", 2, "-Mz", 2, "-orient", 0, 0, 1, 1, 0, 0, "-iter", 200, 1e-6)
zero = [0.0] * len(u)
ops.pattern("MultipleSupport", 1)
for axis, (displacement, velocity) in enumerate([(u, v), (zero, zero), ([-LOAD / 5e9] * len(u), zero)]):
    ops.timeSeries("Path", 10 + axis, "-dt", step, "-values", *displacement, "-useLast")
    ops.timeSeries("Path", 20 + axis, "-dt", step, "-values", *velocity, "-useLast")
    ops.timeSeries("Constant", 30 + axis, "-factor", 0.0)
    ops.groundMotion(axis + 1, "Plain", "-disp", 10 + axis, "-vel", 20 + axis, "-accel", 30 + axis)
    ops.imposedMotion(2, axis + 1, axis + 1)
ops.recorder("Element", "-file", "force.out", "-time", "-precision", 12, "-ele", 1, "force")
ops.constraints("Transformation")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("FixedNumIter", 1)
ops.algorithm("Linear")
ops.integrator("Newmark", 0.5, 0.25)
ops.analysis("Transient")
if ops.analyze(last, step) != 0:
    sys.exit("the analysis failed")
ops.wipe()
'''


def frame(masses):
    return _FRAME.replace("MASSES", repr([float(mass) for mass in masses]), 1)


def slider(load):
    return _SLIDER.replace("LOAD", repr(float(load)), 1)


_VARIABLES = [("a", 0, "input", "m/s2"),
              *((f"f{i + 1}", 1 + i, "input", "N") for i in range(3)),
              *((f"m{i + 1}", 4 + i, "parameter", "kg") for i in range(3)),
              *((f"k{i + 1}", 7 + i, "parameter", "N/m") for i in range(3)),
              *((f"c{i + 1}", 10 + i, "parameter", "N.s/m") for i in range(3)),
              *((f"y{i + 1}", 13 + i, "output", "m") for i in range(3)),
              *((f"d{i + 1}", 16 + i, "output", "m") for i in range(3)),
              *((f"v{i + 1}", 19 + i, "output", "m/s") for i in range(3))]


def _variable(name, reference, causality, unit):
    more = ' variability="fixed"' if causality == "parameter" else ""
    start = "" if causality == "output" else ' start="0"'
    return (f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}"{more}>'
            f'<Real unit="{unit}"{start}/></ScalarVariable>')


FMU_DESCRIPTION = "\n".join([
    '<?xml version="1.0" encoding="UTF-8"?>',
    '<fmiModelDescription fmiVersion="2.0" modelName="chain" guid="{b1d6a2f0-6d3c-4a77-9a55-3b0b1f6f2f10}">',
    '<CoSimulation modelIdentifier="trial_fmu" canHandleVariableCommunicationStepSize="true"/>',
    "<ModelVariables>", *(_variable(*variable) for variable in _VARIABLES), "</ModelVariables>",
    "<ModelStructure/>", "</fmiModelDescription>", ""])

# SPDX-License-Identifier: Apache-2.0
"""Runs of OpenSees: a bearing element along a prescribed motion, and a chain of masses under an input."""
import numpy as np
import openseespy.opensees as ops

FIXED = (1, 1, 1, 1, 1, 1)
VERTICAL_STIFFNESS = 5e9  # of the bearing's axial material [N/m]
FINE = 2  # steps of the analysis per sample, where only differences of two runs count


def _add_auxiliary_mass():
    """The one degree of freedom that the solver needs."""
    ops.node(3, 0.0, 0.0, 0.0)
    ops.node(4, 0.0, 0.0, 0.0)
    ops.fix(3, *FIXED)
    ops.fix(4, 0, 1, 1, 1, 1, 1)
    ops.mass(4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ops.uniaxialMaterial("Elastic", 10_000, 1.0)
    ops.element("zeroLength", 10_000, 3, 4, "-mat", 10_000, "-dir", 1)


def _add_bearing(specimen, beside):
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    ops.node(1, 0.0, 0.0, 0.0)
    ops.node(2, 0.0, 0.0, 0.0)
    ops.fix(1, *FIXED)
    ops.fix(2, 0, 0, 0, 1, 1, 1)
    _add_auxiliary_mass()
    ops.uniaxialMaterial("Elastic", 1, VERTICAL_STIFFNESS)
    ops.uniaxialMaterial("Elastic", 2, 1e6)
    for model in specimen.get("friction", []):
        ops.frictionModel(*model)
    name, *arguments = specimen["element"]
    ops.element(name, 1, 1, 2, *arguments)
    for k, (axis, material) in enumerate(beside):
        ops.uniaxialMaterial(material[0], 100 + k, *material[1:])
        ops.element("zeroLength", 100 + k, 1, 2, "-mat", 100 + k, "-dir", axis + 1)
    return 1 + len(beside)


def _impose(motion, velocity, step):
    ops.pattern("MultipleSupport", 1)
    for axis in range(3):
        for tag, values in ((10, motion), (20, velocity)):
            ops.timeSeries("Path", tag + axis, "-dt", step, "-values", *values[:, axis].tolist(), "-useLast")
        ops.timeSeries("Constant", 30 + axis, "-factor", 0.0)
        ops.groundMotion(axis + 1, "Plain", "-disp", 10 + axis, "-vel", 20 + axis, "-accel", 30 + axis)
        ops.imposedMotion(2, axis + 1, axis + 1)


def bearing_force(specimen, u, v, load, step, beside=(), divisions=FINE):
    """Horizontal forces of a bearing along a motion: samples × 2 [N].

    @param specimen  {"element": name and arguments after the nodes, "friction": friction models}
    @param load      vertical force, compression positive [N]
    @param beside    further uniaxial materials in parallel: (axis, material)
    """
    fine = step / divisions
    t, at = np.arange(len(u)) * step, np.arange((len(u) - 1) * divisions + 1) * fine
    motion = np.stack([*(np.interp(at, t, column) for column in u.T), np.interp(at, t, -load / VERTICAL_STIFFNESS)], 1)
    velocity = np.stack([*(np.interp(at, t, column) for column in v.T), np.zeros(len(at))], 1)
    elements = _add_bearing(specimen, beside)
    _impose(motion, velocity, fine)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("FixedNumIter", 1)
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    force = np.zeros((len(u), 2))
    tags = [1, *range(100, 99 + elements)]
    for k in range(1, len(u)):
        if ops.analyze(divisions, fine) != 0:
            raise RuntimeError(f"OpenSees failed in sample {k} of {len(u)}")
        force[k] = sum(np.array(ops.eleResponse(tag, "force")[6:8]) for tag in tags)
    ops.wipe()
    return force


def chain_response(masses, springs, ground, step, fine=4):
    """Masses on springs to the ground or to each other, under a base acceleration.

    @param springs  (from, to, list of uniaxial materials in parallel); node 0 is the ground
    @returns displacements relative to the base and absolute accelerations: samples × masses
    """
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.fix(1, 1)
    for k, mass in enumerate(masses, 2):
        ops.node(k, 0.0)
        ops.mass(k, mass)
    tag = 1
    for begin, end, materials in springs:
        for material in materials:
            ops.uniaxialMaterial(material[0], tag, *material[1:])
            ops.element("zeroLength", tag, begin + 1, end + 1, "-mat", tag, "-dir", 1)
            tag += 1
    ops.timeSeries("Path", 1, "-dt", step, "-values", *ground.tolist(), "-useLast")
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormUnbalance", 1e-6 * masses[0], 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    return _sampled(len(masses), len(ground), ground, step, fine)


def _sampled(count, samples, ground, step, fine):
    u, a = np.zeros((samples, count)), np.zeros((samples, count))
    for k in range(1, samples):
        if ops.analyze(fine, step / fine) != 0:
            raise RuntimeError(f"OpenSees failed in sample {k} of {samples}")
        u[k] = [ops.nodeDisp(node, 1) for node in range(2, count + 2)]
        a[k] = [ops.nodeAccel(node, 1) for node in range(2, count + 2)]
    ops.wipe()
    return u, a + ground[:, None]

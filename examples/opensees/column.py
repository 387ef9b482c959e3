#!/usr/bin/env python3
"""The frame's left column as a separate model, in kips and inches: a specimen that another solver moves.

usage: column.py PORT [--element adapter|actuator] [--udp]

The last element command waits for a connection to the port. Each step of the analysis then takes a target from it.
"""
import argparse

import openseespy.opensees as ops

STIFFNESS, STRENGTH, HARDENING = 2.8, 4.2, 0.1  # [kip/in], [kip], [-]
FOOT, TOP, PIN = 1, 2, 3
RIGID = 2.8e7  # of the element that holds it at its target [kip/in]: the error is 1e-7 of the displacement

parser = argparse.ArgumentParser()
parser.add_argument("port", type=int)
parser.add_argument("--element", choices=["adapter", "actuator"], default="adapter")
parser.add_argument("--udp", action="store_true")
options = parser.parse_args()
protocol = ["-udp"] if options.udp else []

ops.model("basic", "-ndm", 2, "-ndf", 2)
ops.node(FOOT, 0.0, 0.0)
ops.node(TOP, 0.0, 54.0)
ops.node(PIN, -100.0, 54.0)
ops.fix(FOOT, 1, 1)
ops.fix(TOP, 0, 1)
ops.fix(PIN, 1, 1)
ops.uniaxialMaterial("Steel01", 1, STRENGTH, STIFFNESS, HARDENING)
ops.element("twoNodeLink", 1, FOOT, TOP, "-mat", 1, "-dir", 2, "-orient", 0, 1, 0, -1, 0, 0)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormUnbalance", 1e-8, 50)
ops.algorithm("Newton")
ops.integrator("LoadControl", 1.0)
ops.analysis("Static")
if options.element == "adapter":
    ops.element("adapter", 2, "-node", TOP, "-dof", 1, "-stif", RIGID, options.port, *protocol)
else:  # from the pin on the left to the top: elongation moves the top to the right
    ops.element("actuator", 2, PIN, TOP, RIGID * 100.0, options.port, *protocol)
while ops.analyze(1) == 0:
    pass

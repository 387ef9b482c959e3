#!/usr/bin/env python3
"""The example brick_plant.py, in which OpenSees records the absolute acceleration of a node.

usage: recorded_bricks.py SCRIPT FILE NODE ARGUMENT…: time [s], accelerations x and y [m/s2], by spaces, at each step
"""
import runpy
import sys

import openseespy.opensees as ops

script, file, node = sys.argv[1], sys.argv[2], int(sys.argv[3])
sys.argv[:] = [script, *sys.argv[4:]]
analysis = ops.analysis


def with_recorder(*arguments):
    if node in ops.getNodeTags() and ops.getNP() - 1 == ops.getPID():  # once
        ops.recorder("Node", "-file", file, "-precision", 15, "-timeSeries", 1, 2, "-time", "-node", node, "-dof", 1, 2, "accel")
    return analysis(*arguments)


ops.analysis = with_recorder
runpy.run_path(script, run_name="__main__")

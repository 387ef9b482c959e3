"""A controller: the reference moves along a straight line to each new target, ahead of it by the machine's delay.

Flags precede the inputs that they guard and follow the outputs.
"""
import numpy

import rths

AXES, INTERVAL_S, MOVE = ("long", "lat"), 0.01, 8  # between targets; steps of a move
PLATEN, WEIGHT = 115e3, 9685600  # [kg], [N]


class Controller(rths.Adapter):
    signals = [
        rths.Input("opf.newTarget"),
        *(rths.Input(f"opf.{axis}.displ.target", "m") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.displ.fbk", "m") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.accel.fbk", "m/s2") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.force.fbk", "N") for axis in AXES),
        rths.Input("opf.vert.force.target", "N"),
        rths.Parameter("delay", "s", 0.06, range=(0, 1)),
        *(rths.Output(f"xpc.{axis}.displ.ref", "m", ramp=True) for axis in AXES),
        rths.Output("xpc.compression.force.ref", "N"),
        *(rths.Output(f"daq.{axis}.displ.fbk", "m") for axis in AXES),
        *(rths.Output(f"daq.{axis}.force.fbk", "N") for axis in AXES),
        *(rths.Monitor(f"observer.force.{axis}", "N") for axis in AXES),  # of the report
        rths.Output("daq.atTarget", range=(0, 1)),
        rths.Output("daq.switchPC", range=(0, 1)),
    ]

    def activate(self):  # the initial state, also at a restart
        self.target, self.end, self.left = numpy.zeros(2), numpy.zeros(2), 0  # [m], [m], steps of this move

    def step(self, time_s, inputs, outputs):
        has_target, target, load, delay = inputs[0] > 0, inputs[1:3].copy(), inputs[9], inputs[10]
        if has_target and self.left == 0:
            self.end, self.target, self.left = target + delay / INTERVAL_S * (target - self.target), target, MOVE
        outputs[7:9] = inputs[7:9] - PLATEN * inputs[5:7]
        if self.left > has_target:  # the last step waits for the flag to fall
            outputs[0:2] += (self.end - outputs[0:2]) / self.left
            outputs[3:5], outputs[5:7] = inputs[3:5], outputs[7:9]  # stay while the solver reads them
            self.left -= 1
        outputs[2], outputs[9], outputs[10] = WEIGHT + load, self.left == 0, has_target

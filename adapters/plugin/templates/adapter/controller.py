"""A controller: on a new target, it moves the reference along a straight line, ahead of the target by the machine's delay.

Flags precede the inputs that they guard and follow the outputs.
"""
import numpy

import rths

AXES = ("long", "lat")


class Controller(rths.Adapter):
    signals = [
        rths.Input("opf.newTarget"),
        *(rths.Input(f"opf.{axis}.displ.target", "m") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.displ.fbk", "m") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.accel.fbk", "m/s2") for axis in AXES),
        *(rths.Input(f"srmd.{axis}.force.fbk", "N") for axis in AXES),
        rths.Input("opf.vert.force.target", "N"),
        rths.Parameter("interval", "s", 0.01, range=(0.001, 10)),  # between targets
        rths.Parameter("move", "s", 0.007, range=(0.001, 10)),
        rths.Parameter("delay", "s", 0.06, range=(0, 1)),
        rths.Parameter("platen", "kg", 115e3, range=(0, 1e6)),  # its inertia is in the measured force
        rths.Parameter("weight", "N", 9685600, range=(0, 53.4e6)),
        *(rths.Output(f"xpc.{axis}.displ.ref", "m", ramp=True) for axis in AXES),
        rths.Output("xpc.compression.force.ref", "N"),
        *(rths.Output(f"daq.{axis}.displ.fbk", "m") for axis in AXES),
        *(rths.Output(f"daq.{axis}.force.fbk", "N") for axis in AXES),
        *(rths.Monitor(f"observer.force.{axis}", "N") for axis in AXES),  # role `force` of the report
        rths.Output("daq.atTarget", range=(0, 1)),
        rths.Output("daq.switchPC", range=(0, 1)),
    ]

    def activate(self):  # the initial state, also at a restart
        self.target, self.start, self.end = numpy.zeros((3, 2))  # [m]
        self.begun_s, self.has_target, self.moves = 0.0, False, False

    def step(self, time_s, inputs, outputs):
        has_target, target, load = inputs[0] > 0, inputs[1:3], inputs[9]
        interval, move, delay, platen, weight = inputs[10:]
        if has_target and not self.has_target:
            self.start = outputs[0:2].copy()
            self.end = target + delay / interval * (target - self.target)
            self.target, self.begun_s, self.moves = target.copy(), time_s, True
        self.has_target = has_target
        x = min((time_s - self.begun_s) / move, 1.0)
        outputs[0:2] = self.start + x * (self.end - self.start)
        outputs[2] = weight + load
        outputs[7:9] = inputs[7:9] - platen * inputs[5:7]
        if x >= 1 and not has_target and self.moves:  # at the target: the solver gets its feedback
            self.moves = False
            outputs[3:5], outputs[5:7] = inputs[3:5], outputs[7:9]
        outputs[9], outputs[10] = not self.moves, has_target

"""A test machine: a valve and a platen that follow the reference, and a specimen that is a spring."""
import numpy

import rths

STROKE, DAMPING, VALVE = 1.5, 0.7, 0.01  # [m], [-], [s]
AXES = ("long", "lat")


class Machine(rths.Adapter):
    signals = [
        *(rths.Input(f"xpc.{axis}.displ.ref", "m") for axis in AXES),
        rths.Input("xpc.compression.force.ref", "N"),
        rths.Parameter("bandwidth", "rad/s", 40, range=(1, 500)),
        rths.Parameter("stiffness", "N/m", 5e6, range=(0, 1e9)),
        rths.Parameter("platen", "kg", 115e3, range=(0, 1e6)),
        *(rths.Output(f"srmd.{axis}.displ.fbk", "m", range=(-STROKE, STROKE)) for axis in AXES),
        *(rths.Output(f"srmd.{axis}.accel.fbk", "m/s2") for axis in AXES),
        *(rths.Output(f"srmd.{axis}.force.fbk", "N") for axis in AXES),
        *(rths.Output(f"srmd.{axis}.displ.ref_echo", "m") for axis in AXES),
        rths.Output("srmd.compression.force.fbk", "N"),
    ]

    def activate(self):  # the initial state, also at a restart
        self.valve, self.x, self.v = numpy.zeros((3, 2))  # [m], [m], [m/s]
        self.last_s = 0.0

    def step(self, time_s, inputs, outputs):
        reference, (load, bandwidth, stiffness, platen) = inputs[:2], inputs[2:]
        passed, self.last_s = time_s - self.last_s, time_s
        self.valve += (reference - self.valve) * passed / (passed + VALVE)
        acceleration = bandwidth * (bandwidth * (self.valve - self.x) - 2 * DAMPING * self.v)
        self.v += acceleration * passed
        self.x += self.v * passed
        is_limited = (abs(self.x) > STROKE).any()
        self.x = self.x.clip(-STROKE, STROKE)
        outputs[0:2], outputs[2:4] = self.x, acceleration
        outputs[4:6] = stiffness * self.x + platen * acceleration
        outputs[6:8], outputs[8] = reference, load
        return rths.Status.LIMIT_EXCEEDED if is_limited else rths.Status.OK

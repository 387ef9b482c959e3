// A controller: the reference moves along a straight line to each new target, ahead of it by the
// delay of the machine. Flags precede the inputs that they guard and follow the outputs.
#include <rths_adapter.hpp>

enum In { kNew, kTarget, kVeloc = 3, kLoad = 5, kDispl, kAccel = 8, kForce = 10, kDelay = 12 };
enum Out { kRef, kCompression = 2, kFeedback, kFed = 5, kSpecimen = 7, kAtTarget = 9, kSwitch };
constexpr int kAxes = 2, kMove = 8, kPlaten = 115000,
              kWeight = 9685600;  // steps of 1 ms, [kg], [N]

constexpr rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("opf.", ".displ.target", "m", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("opf.", ".veloc.target", "m/s", RTHS_INPUT, 0, 0, 0, 0),
    {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("srmd.", ".displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0),
    {"delay", "s", RTHS_PARAMETER, 0, 0.06, 0, 1},
    RTHS_LONG_LAT("xpc.", ".displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0),
    {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("daq.", ".displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("daq.", ".force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("observer.force.", "", "N", RTHS_MONITOR, 0, 0, 0, 0),  // of the report
    {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
    {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1},
};

struct Controller {
  int left = 0;  // steps of this move

  rths_status step(double /*time_s*/, const double* in, double* out) noexcept {
    const bool has_target = in[kNew] > 0;
    if (has_target && left == 0) left = kMove;
    const int moves = left > has_target;  // the last step waits for the flag to fall
    for (int i = 0; i < kAxes; ++i) {
      const double end = in[kTarget + i] + in[kDelay] * in[kVeloc + i];
      if (moves) out[kRef + i] += (end - out[kRef + i]) / left;
      out[kFeedback + i] = in[kDispl + i];
      out[kFed + i] = out[kSpecimen + i] = in[kForce + i] - kPlaten * in[kAccel + i];
    }
    left -= moves;
    out[kCompression] = kWeight + in[kLoad];
    out[kAtTarget] = left == 0;
    out[kSwitch] = has_target;
    return RTHS_OK;
  }
};
RTHS_SIMPLE_ADAPTER(Controller, "@NAME@", "0.1", kSignals)

// A controller: the reference moves along a straight line to each new target, ahead of it by the
// delay of the machine. Flags precede the inputs that they guard and follow the outputs.
#include <rths_adapter.hpp>

enum In { kNew, kTarget, kLoad = 3, kDisplacement, kAcceleration = 6, kForce = 8, kDelay = 10 };
enum Out { kRef, kCompression = 2, kFeedback, kFed = 5, kSpecimen = 7, kAtTarget = 9, kSwitch };
constexpr int kAxes = 2, kMove = 8;                                     // steps of 1 ms
constexpr double kInterval = 0.01, kPlaten = 115e3, kWeight = 9685600;  // [s], [kg], [N]

constexpr rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("opf.", ".displ.target", "m", RTHS_INPUT, 0, 0, 0, 0),
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
  double target[kAxes] = {}, end[kAxes] = {};  // [m]
  int left = 0;                                // steps of this move

  rths_status step(double /*time_s*/, const double* in, double* out) noexcept {
    const bool has_target = in[kNew] > 0, is_new = has_target && left == 0;
    if (is_new) left = kMove;
    const bool moves = left > (has_target ? 1 : 0);  // the last step waits for the flag to fall
    for (int i = 0; i < kAxes; ++i) {
      out[kSpecimen + i] = in[kForce + i] - kPlaten * in[kAcceleration + i];
      if (is_new) {
        end[i] = in[kTarget + i] + in[kDelay] / kInterval * (in[kTarget + i] - target[i]);
        target[i] = in[kTarget + i];
      }
      if (!moves) continue;
      out[kRef + i] += (end[i] - out[kRef + i]) / left;
      out[kFeedback + i] = in[kDisplacement + i];  // stays while the solver reads it
      out[kFed + i] = out[kSpecimen + i];
    }
    if (moves) --left;
    out[kCompression] = kWeight + in[kLoad];
    out[kAtTarget] = left == 0;
    out[kSwitch] = has_target;
    return RTHS_OK;
  }
};
RTHS_SIMPLE_ADAPTER(Controller, "@NAME@", "0.1", kSignals)

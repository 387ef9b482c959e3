// A test machine: a valve and a platen follow the reference, and the specimen is a spring.
#include <algorithm>
#include <rths_adapter.hpp>

constexpr double kStroke = 1.5, kDamping = 0.7, kValve = 0.01;  // [m], [-], [s]
enum In { kAxes = 2, kLoad = kAxes, kBandwidth, kStiffness, kPlaten };
enum Out { kDisplacement, kAcceleration = 2, kForce = 4, kEcho = 6, kCompression = 8 };

constexpr rths_signal kSignals[] = {
    RTHS_LONG_LAT("xpc.", ".displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0),
    {"xpc.compression.force.ref", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"bandwidth", "rad/s", RTHS_PARAMETER, 0, 40, 1, 500},
    {"stiffness", "N/m", RTHS_PARAMETER, 0, 5e6, 0, 1e9},
    {"platen", "kg", RTHS_PARAMETER, 0, 115e3, 0, 1e6},
    RTHS_LONG_LAT("srmd.", ".displ.fbk", "m", RTHS_OUTPUT, 0, 0, -kStroke, kStroke),
    RTHS_LONG_LAT("srmd.", ".accel.fbk", "m/s2", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0),
    {"srmd.compression.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
};

struct Machine {
  double valve[kAxes] = {}, displacement[kAxes] = {}, velocity[kAxes] = {}, last_time = 0;

  rths_status step(double time_s, const double* in, double* out) noexcept {
    const double passed = time_s - last_time, bandwidth = in[kBandwidth];
    rths_status status = RTHS_OK;
    for (int i = 0; i < kAxes; ++i) {
      double &x = displacement[i], &v = velocity[i];
      valve[i] += (in[i] - valve[i]) * passed / (passed + kValve);
      const double acceleration = bandwidth * (bandwidth * (valve[i] - x) - 2 * kDamping * v);
      v += acceleration * passed;
      x += v * passed;
      if (x < -kStroke || x > kStroke) status = RTHS_LIMIT_EXCEEDED;
      out[kDisplacement + i] = x = std::clamp(x, -kStroke, kStroke);
      out[kAcceleration + i] = acceleration;
      out[kForce + i] = in[kStiffness] * x + in[kPlaten] * acceleration;
      out[kEcho + i] = in[i];
    }
    out[kCompression] = in[kLoad];
    last_time = time_s;
    return status;
  }
};
RTHS_SIMPLE_ADAPTER(Machine, "@NAME@", "0.1", kSignals)

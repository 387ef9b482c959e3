// A test machine: a valve and a platen that follow the reference, and a specimen that is a spring.
#include <algorithm>
#include <array>

#include <rths_adapter.hpp>

constexpr double kStroke = 1.5, kDamping = 0.7, kValve = 0.01;  // [m], [-], [s]
constexpr int kAxes = 2;
enum In { kLoad = kAxes, kBandwidth, kStiffness, kPlaten };
enum Out { kDisplacement, kAcceleration = 2, kForce = 4, kEcho = 6, kCompression = 8 };

class Machine final : public rths::PluginBase {
 public:
  explicit Machine(const char* /*config_toml*/) {}  // no settings of its own

  std::vector<rths_signal> signals() const override {
    return {{"xpc.long.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"xpc.lat.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"xpc.compression.force.ref", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"bandwidth", "rad/s", RTHS_PARAMETER, 0, 40, 1, 500},
            {"stiffness", "N/m", RTHS_PARAMETER, 0, 5e6, 0, 1e9},
            {"platen", "kg", RTHS_PARAMETER, 0, 115e3, 0, 1e6},
            {"srmd.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -kStroke, kStroke},
            {"srmd.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -kStroke, kStroke},
            {"srmd.long.accel.fbk", "m/s2", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.lat.accel.fbk", "m/s2", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.long.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.lat.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.compression.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0}};
  }
  void activate() override { *this = Machine{""}; }  // the initial state, also at a restart

  rths_status step(double time_s, const double* in, double* out) noexcept override {
    const double passed = time_s - last_time_, bandwidth = in[kBandwidth];
    last_time_ = time_s;
    rths_status status = RTHS_OK;
    for (std::size_t i = 0; i < kAxes; ++i) {
      double &x = displacement_[i], &v = velocity_[i], &valve = valve_[i];
      valve += (in[i] - valve) * passed / (passed + kValve);
      const double acceleration = bandwidth * (bandwidth * (valve - x) - 2 * kDamping * v);
      v += acceleration * passed;
      x += v * passed;
      if (x < -kStroke || x > kStroke) status = RTHS_LIMIT_EXCEEDED;
      x = std::clamp(x, -kStroke, kStroke);
      out[kDisplacement + i] = x;
      out[kAcceleration + i] = acceleration;
      out[kForce + i] = in[kStiffness] * x + in[kPlaten] * acceleration;
      out[kEcho + i] = in[i];
    }
    out[kCompression] = in[kLoad];
    return status;
  }

 private:
  std::array<double, kAxes> valve_{}, displacement_{}, velocity_{};  // [m], [m/s]
  double last_time_ = 0;                                             // [s]
};

RTHS_EXPORT_ADAPTER(Machine, "@NAME@", "0.1")

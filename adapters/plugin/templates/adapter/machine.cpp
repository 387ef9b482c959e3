// A test machine: a first-order lag, and a specimen that is a spring.
#include <algorithm>
#include <array>

#include <rths_adapter.hpp>

namespace {

constexpr double kStroke = 1.5;  // [m]
constexpr std::size_t kAxes = 2;
enum In : std::size_t { kReference, kLag = kAxes, kStiffness };
enum Out : std::size_t { kDisplacement, kForce = kAxes, kEcho = 2 * kAxes };

class Machine final : public rths::PluginBase {
 public:
  explicit Machine(const char* /*config_toml*/) {}  // no settings of its own

  std::vector<rths_signal> signals() const override {
    return {{"xpc.long.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"xpc.lat.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"lag", "s", RTHS_PARAMETER, 0, 0.02, 0.001, 1},
            {"stiffness", "N/m", RTHS_PARAMETER, 0, 5e6, 0, 1e9},
            {"srmd.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -kStroke, kStroke},
            {"srmd.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -kStroke, kStroke},
            {"srmd.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.long.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"srmd.lat.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0}};
  }
  // The initial state, also at a restart.
  void activate() override { displacement_ = {}, last_time_ = 0; }

  rths_status step(double time_s, const double* in, double* out) noexcept override {
    const double passed = time_s - last_time_;
    last_time_ = time_s;
    rths_status status = RTHS_OK;
    for (std::size_t i = 0; i < kAxes; ++i) {
      double& x = displacement_[i];
      x += (in[kReference + i] - x) * passed / (passed + in[kLag]);
      if (x < -kStroke || x > kStroke) status = RTHS_LIMIT_EXCEEDED;
      x = std::clamp(x, -kStroke, kStroke);
      out[kDisplacement + i] = x;
      out[kForce + i] = in[kStiffness] * x;
      out[kEcho + i] = in[kReference + i];
    }
    return status;
  }

 private:
  std::array<double, kAxes> displacement_{};  // [m]
  double last_time_ = 0;                      // [s]
};

}  // namespace

RTHS_EXPORT_ADAPTER(Machine, "@NAME@", "0.1")

// A controller: on a new target, it moves the reference along a straight line for one step.
#include <algorithm>
#include <array>

#include <rths_adapter.hpp>

namespace {

constexpr std::size_t kAxes = 2;
enum In : std::size_t {
  kNewTarget,
  kTarget,
  kDisplacement = kTarget + kAxes,
  kForce = kDisplacement + kAxes,
  kLoad = kForce + kAxes,
  kStep,
  kWeight
};
enum Out : std::size_t {
  kReference,
  kCompression = kAxes,
  kFeedback,
  kFedForce = kFeedback + kAxes,
  kAtTarget = kFedForce + kAxes,
  kSwitch
};

class Controller final : public rths::PluginBase {
 public:
  explicit Controller(const char* /*config_toml*/) {}  // no settings of its own

  // Inputs are read in this order, so the flag comes before the targets. Outputs are written in
  // this order, so the flags come last.
  std::vector<rths_signal> signals() const override {
    return {{"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.long.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.lat.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.long.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.lat.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.long.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.lat.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"step", "s", RTHS_PARAMETER, 0, 0.007, 0.001, 10},
            {"weight", "N", RTHS_PARAMETER, 0, 9685600, 0, 53.4e6},
            {"xpc.long.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
            {"xpc.lat.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
            {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
            {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1}};
  }
  // The initial state, also at a restart.
  void activate() override { *this = Controller{""}; }

  rths_status step(double time_s, const double* in, double* out) noexcept override {
    const bool has_target = in[kNewTarget] > 0;
    if (has_target && !has_target_) {  // takes the target and answers with switchPC
      std::copy_n(out + kReference, kAxes, from_.begin());
      std::copy_n(in + kTarget, kAxes, to_.begin());
      begun_ = time_s;
      at_target_ = false;
    }
    has_target_ = has_target;
    const double x = std::min((time_s - begun_) / in[kStep], 1.0);
    for (std::size_t i = 0; i < kAxes; ++i)
      out[kReference + i] = from_[i] + x * (to_[i] - from_[i]);
    out[kCompression] = in[kWeight] + in[kLoad];
    if (x >= 1 && !has_target && !at_target_) {
      at_target_ = true;
      std::copy_n(in + kDisplacement, kAxes, out + kFeedback);
      std::copy_n(in + kForce, kAxes, out + kFedForce);
    }
    out[kAtTarget] = at_target_;
    out[kSwitch] = has_target;
    return RTHS_OK;
  }

 private:
  std::array<double, kAxes> from_{}, to_{};  // [m]
  double begun_ = 0;                         // [s]
  bool has_target_ = false, at_target_ = true;
};

}  // namespace

RTHS_EXPORT_ADAPTER(Controller, "@NAME@", "0.1")

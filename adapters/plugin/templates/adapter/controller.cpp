// A controller: on a new target, it moves the reference along a straight line, ahead of the target
// by the delay of the machine. Flags precede the inputs that they guard and follow the outputs.
#include <algorithm>
#include <array>

#include <rths_adapter.hpp>

constexpr std::size_t kAxes = 2;
enum In { kNewTarget, kTarget, kDisplacement = 3, kAcceleration = 5, kForce = 7, kLoad = 9 };
enum Parameter { kInterval = 10, kMove, kDelay, kPlaten, kWeight };
enum Out {
  kReference,
  kCompression = 2,
  kFeedback,
  kFed = 5,
  kSpecimen = 7,
  kAtTarget = 9,
  kSwitch
};

class Controller final : public rths::PluginBase {
 public:
  explicit Controller(const char* /*config_toml*/) {}  // no settings of its own

  std::vector<rths_signal> signals() const override {
    return {{"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.long.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.lat.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.long.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.lat.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.long.accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.lat.accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.long.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"srmd.lat.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
            {"interval", "s", RTHS_PARAMETER, 0, 0.01, 0.001, 10},  // between targets
            {"move", "s", RTHS_PARAMETER, 0, 0.007, 0.001, 10},
            {"delay", "s", RTHS_PARAMETER, 0, 0.06, 0, 1},
            {"platen", "kg", RTHS_PARAMETER, 0, 115e3, 0, 1e6},  // its inertia is in the force
            {"weight", "N", RTHS_PARAMETER, 0, 9685600, 0, 53.4e6},
            {"xpc.long.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
            {"xpc.lat.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
            {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"daq.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
            {"observer.force.long", "N", RTHS_MONITOR, 0, 0, 0, 0},  // role `force` of the report
            {"observer.force.lat", "N", RTHS_MONITOR, 0, 0, 0, 0},
            {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
            {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1}};
  }
  void activate() override { *this = Controller{""}; }  // the initial state, also at a restart

  rths_status step(double time_s, const double* in, double* out) noexcept override {
    const bool has_target = in[kNewTarget] > 0;
    for (std::size_t i = 0; has_target && !has_target_ && i < kAxes; ++i) {
      const double target = in[kTarget + i];
      from_[i] = out[kReference + i];
      to_[i] = target + in[kDelay] / in[kInterval] * (target - target_[i]);
      target_[i] = target;
      begun_ = time_s;
      moves_ = true;
    }
    has_target_ = has_target;
    const double x = std::min((time_s - begun_) / in[kMove], 1.0);
    for (std::size_t i = 0; i < kAxes; ++i) {
      out[kReference + i] = from_[i] + x * (to_[i] - from_[i]);
      out[kSpecimen + i] = in[kForce + i] - in[kPlaten] * in[kAcceleration + i];
    }
    out[kCompression] = in[kWeight] + in[kLoad];
    if (x >= 1 && !has_target && moves_) {  // at the target: the solver gets its feedback
      moves_ = false;
      std::copy_n(in + kDisplacement, kAxes, out + kFeedback);
      std::copy_n(out + kSpecimen, kAxes, out + kFed);
    }
    out[kAtTarget] = !moves_;
    out[kSwitch] = has_target;
    return RTHS_OK;
  }

 private:
  std::array<double, kAxes> target_{}, from_{}, to_{};  // [m]
  double begun_ = 0;                                    // [s]
  bool has_target_ = false, moves_ = false;
};

RTHS_EXPORT_ADAPTER(Controller, "@NAME@", "0.1")

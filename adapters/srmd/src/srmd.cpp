// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr int kUserInputs = 8;
constexpr int kOutriggers = 4;
constexpr const char* kOutriggerNames[kOutriggers] = {"ne", "se", "nw", "sw"};

enum In : std::size_t {
  kRefLong,
  kRefLat,
  kRefVert,
  kRefCompression,
  kUserInput,
  kInputs = kUserInput + kUserInputs
};
enum Out : std::size_t {
  kEchoLong,
  kEchoLat,
  kEchoVert,
  kEchoCompression,
  kDisplLong,
  kDisplLat,
  kDisplVert,
  kCompression,
  kAccelLong,
  kAccelLat,
  kForceLong,
  kForceLat,
  kForceVert,
  kOutrigger,
  kLiftPressure = kOutrigger + kOutriggers,
  kUserEcho,
  kTrueDispl = kUserEcho + kUserInputs,
  kTrueForce = kTrueDispl + sim::kHorizontalAxes,
};

class Srmd final : public Adapter {
 public:
  explicit Srmd(const SrmdSettings& settings)
      : settings_{settings},
        machine_{settings.machine, settings.period},
        compression_{settings.machine.specimen.axial_load} {
    for (const auto& axis : settings.axes)
      if (!horizontal_axis_named(axis))
        throw Error{"srmd: axis '" + axis + "' is not driven, expected long or lat"};
    if (compression_ > sim::kVerticalCapacity)
      throw Error{fmt::format("srmd: the specimen carries {:.4g} MN, expected at most {:g} MN",
                              compression_ * 1e-6, sim::kVerticalCapacity * 1e-6)};
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    const auto in = [&](const std::string& name, const char* unit) {
      ports.push_back({name, Direction::Input, unit, 0, false});
    };
    const auto out = [&](const std::string& name, const char* unit) {
      ports.push_back({name, Direction::Output, unit, 0, false});
    };
    for (const std::string& axis : names_of(kTranslations)) in("xpc." + axis + ".displ.ref", "m");
    in("xpc.compression.force.ref", "N");
    for (int i = 1; i <= kUserInputs; ++i) in("xpc." + std::to_string(i) + ".user_input", "V");

    for (const std::string& axis : names_of(kTranslations))
      out("srmd." + axis + ".displ.ref_echo", "m");
    out("srmd.compression.force.ref_echo", "N");
    for (const std::string& axis : names_of(kTranslations)) out("srmd." + axis + ".displ.fbk", "m");
    out("srmd.compression.force.fbk", "N");
    for (const std::string& axis : names_of(kHorizontal))
      out("srmd." + axis + ".accel.fbk", "m/s2");
    for (const std::string& axis : names_of(kTranslations)) out("srmd." + axis + ".force.fbk", "N");
    for (const char* corner : kOutriggerNames)
      out(std::string{"srmd."} + corner + ".outrigger.force.fbk", "N");
    out("srmd.lift.pressure.fbk", "Pa");
    for (int i = 1; i <= kUserInputs; ++i)
      out("srmd." + std::to_string(i) + ".user_input_echo", "V");

    for (const std::string& axis : names_of(kHorizontal))
      ports.push_back({"true.displ." + axis, Direction::Monitor, "m", 0, false});
    for (const std::string& axis : names_of(kHorizontal))
      ports.push_back({"true.force." + axis, Direction::Monitor, "N", 0, false});
    return ports;
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const Eigen::Vector2d now = reference(step);
    // An empty table without rollers has nothing to press on.
    const bool is_loaded = settings_.machine.has_specimen || settings_.machine.has_rollers;
    const double reference_load =
        is_loaded ? std::min(step.inputs[kRefCompression], sim::kVerticalCapacity) : 0;
    compression_ += (reference_load - compression_) * settings_.period /
                    (settings_.period + settings_.compression_time_constant);
    const Status status = machine_.step(now, compression_, feedback_);
    step.outputs[kEchoLong] = now[0];
    step.outputs[kEchoLat] = now[1];
    write_feedback(step);
    if (step.stopping && settings_.retreat.finished(step.time - stopped_at_)) return Status::Done;
    if (step.inputs[kRefCompression] > sim::kVerticalCapacity)
      return worst(status, Status::LimitExceeded);
    return status;
  }

 private:
  [[nodiscard]] bool moves(int axis) const noexcept {
    return contains(settings_.axes, kHorizontal[static_cast<std::size_t>(axis)]);
  }

  // While stopping, the machine ignores its inputs: it holds its last reference and ramps it down.
  [[nodiscard]] Eigen::Vector2d reference(const StepData& step) noexcept {
    if (!step.stopping) {
      held_ = {moves(0) ? step.inputs[kRefLong] : 0.0, moves(1) ? step.inputs[kRefLat] : 0.0};
      return held_;
    }
    if (stopped_at_ < 0) stopped_at_ = step.time;
    return settings_.retreat.fraction(step.time - stopped_at_) * held_;
  }

  void write_feedback(const StepData& step) const noexcept {
    const auto& out = step.outputs;
    out[kEchoVert] = step.inputs[kRefVert];
    out[kEchoCompression] = step.inputs[kRefCompression];
    out[kDisplLong] = feedback_.displacement[0];
    out[kDisplLat] = feedback_.displacement[1];
    out[kDisplVert] = step.inputs[kRefVert];
    out[kCompression] = feedback_.axial_load;
    out[kAccelLong] = feedback_.acceleration[0];
    out[kAccelLat] = feedback_.acceleration[1];
    out[kForceLong] = feedback_.force[0];
    out[kForceLat] = feedback_.force[1];
    out[kForceVert] = feedback_.axial_load;
    for (std::size_t i = 0; i < kOutriggers; ++i)
      out[kOutrigger + i] = feedback_.axial_load / kOutriggers;
    out[kLiftPressure] = settings_.lift_pressure;
    for (std::size_t i = 0; i < kUserInputs; ++i) out[kUserEcho + i] = step.inputs[kUserInput + i];
    for (int i = 0; i < sim::kHorizontalAxes; ++i) {
      out[kTrueDispl + static_cast<std::size_t>(i)] = machine_.true_displacement()[i];
      out[kTrueForce + static_cast<std::size_t>(i)] = machine_.specimen_force()[i];
    }
  }

  SrmdSettings settings_;
  sim::TestMachineRun machine_;
  sim::MachineFeedback feedback_;
  Eigen::Vector2d held_ = Eigen::Vector2d::Zero();
  double stopped_at_ = -1;
  double compression_;  // applied before the test begins
};

}  // namespace

std::unique_ptr<Adapter> make_srmd(const SrmdSettings& settings) {
  return std::make_unique<Srmd>(settings);
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd.hpp>

#include <algorithm>
#include <array>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/sim/machine/platen_run.hpp>

namespace rths::adapters {
namespace {

using sim::machine::Vector6;

constexpr const char* kCorners[] = {"ne", "se", "nw", "sw"};
constexpr std::size_t kTranslations = 3, kAll = 6;
constexpr int kUserWords = 8;
constexpr double kVoltsPerGain = 10;  // of user input 1 [V]

// In the order of the words of the ring.
namespace words {
enum Read : std::size_t { kReference, kLoad = kReference + kAll, kUserInput };
enum Written : std::size_t {
  kEcho,
  kLoadEcho = kEcho + kAll,
  kDisplacement,
  kCompression = kDisplacement + kAll,
  kAcceleration,
  kForce = kAcceleration + kTranslations,
  kOutrigger = kForce + kAll,
  kLiftPressure = kOutrigger + sim::machine::kArms,
  kUserEcho,
  kTrueDisplacement = kUserEcho + kUserWords,
  kTrueForce = kTrueDisplacement + kTranslations,
  kSupplyPressure = kTrueForce + kTranslations
};
}  // namespace words

class SrmdPlaten final : public Adapter {
 public:
  explicit SrmdPlaten(const SrmdPlatenSettings& settings)
      : settings_{settings}, machine_{settings.machine, settings.period} {
    for (const auto& axis : settings.axes)
      if (!horizontal_axis_named(axis))
        throw Error{"srmd: axis '" + axis + "' is not driven, expected long or lat"};
    driven_.fill(true);
    for (const Axis axis : kHorizontal) driven_[index_of(axis)] = contains(settings.axes, axis);
    held_.axial_load = settings.machine.carries_load() ? settings.machine.specimen.axial_load : 0;
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    const auto add = [&](Direction direction, const std::string& name, const char* unit) {
      ports.push_back({name, direction, unit, 0, false});
    };
    const auto add_each = [&](Direction direction, std::size_t first, std::size_t last,
                              const char* before, const char* after, const char* unit) {
      for (std::size_t i = first; i < last; ++i) {
        std::string name = before;
        name += name_of(kAxes[i]);
        name += after;
        add(direction, name, unit);
      }
    };
    const auto add_displacements = [&](Direction direction, const char* node, const char* word) {
      add_each(direction, 0, kTranslations, node, word, "m");
      add_each(direction, kTranslations, kAll, node, word, "rad");
    };
    const auto add_user_words = [&](Direction direction, const char* node, const char* word) {
      for (int i = 1; i <= kUserWords; ++i) add(direction, node + std::to_string(i) + word, "V");
    };
    add_displacements(Direction::Input, "xpc.", ".displ.ref");
    add(Direction::Input, "xpc.compression.force.ref", "N");
    add_user_words(Direction::Input, "xpc.", ".user_input");

    add_displacements(Direction::Output, "srmd.", ".displ.ref_echo");
    add(Direction::Output, "srmd.compression.force.ref_echo", "N");
    add_displacements(Direction::Output, "srmd.", ".displ.fbk");
    add(Direction::Output, "srmd.compression.force.fbk", "N");
    add_each(Direction::Output, 0, kTranslations, "srmd.", ".accel.fbk", "m/s2");
    add_each(Direction::Output, 0, kTranslations, "srmd.", ".force.fbk", "N");
    add_each(Direction::Output, kTranslations, kAll, "srmd.", ".moment.fbk", "N.m");
    for (const char* corner : kCorners)
      add(Direction::Output, std::string{"srmd."} + corner + ".outrigger.force.fbk", "N");
    add(Direction::Output, "srmd.lift.pressure.fbk", "Pa");
    add_user_words(Direction::Output, "srmd.", ".user_input_echo");

    add_each(Direction::Monitor, 0, kTranslations, "true.displ.", "", "m");
    add_each(Direction::Monitor, 0, kTranslations, "true.force.", "", "N");
    add(Direction::Monitor, "supply.pressure", "Pa");
    return ports;
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const sim::machine::PlatenReference now = reference(step);
    const Status status = machine_.step(now, feedback_);
    write(step, now);
    if (step.stopping && settings_.retreat.finished(step.time - stopped_at_)) return Status::Done;
    return status;
  }

 private:
  // While stopping, the machine ignores its inputs: it ramps its displacements down and keeps the
  // specimen's load. Before the controller writes its first load, it keeps the load of the start.
  [[nodiscard]] sim::machine::PlatenReference reference(const StepData& step) noexcept {
    if (!step.stopping) {
      for (std::size_t i = 0; i < kAll; ++i)
        held_.displacement[static_cast<Eigen::Index>(i)] =
            driven_[i] ? step.inputs[words::kReference + i] : 0;
      if (step.inputs[words::kLoad] != 0) held_.axial_load = step.inputs[words::kLoad];
      held_.feed_forward = step.inputs[words::kUserInput] / kVoltsPerGain;
      return held_;
    }
    if (stopped_at_ < 0) stopped_at_ = step.time;
    sim::machine::PlatenReference now = held_;
    now.displacement *= settings_.retreat.fraction(step.time - stopped_at_);
    return now;
  }

  void write(const StepData& step, const sim::machine::PlatenReference& now) const noexcept {
    const auto& out = step.outputs;
    const auto put = [&](std::size_t at, const auto& values) {
      for (Eigen::Index i = 0; i < values.size(); ++i)
        out[at + static_cast<std::size_t>(i)] = values[i];
    };
    put(words::kEcho, now.displacement);
    out[words::kLoadEcho] = now.axial_load;
    put(words::kDisplacement, feedback_.displacement);
    out[words::kCompression] = feedback_.force[2];
    put(words::kAcceleration, feedback_.acceleration);
    put(words::kForce, feedback_.force);
    for (std::size_t i = 0; i < sim::machine::kArms; ++i)
      out[words::kOutrigger + i] = feedback_.outrigger_force[i];
    out[words::kLiftPressure] = settings_.machine.friction.lift_pressure;
    for (std::size_t i = 0; i < kUserWords; ++i)
      out[words::kUserEcho + i] = step.inputs[words::kUserInput + i];
    put(words::kTrueDisplacement, machine_.pose().position);
    put(words::kTrueForce, machine_.specimen_force());
    out[words::kTrueForce + 2] = machine_.axial_load();
    out[words::kSupplyPressure] = machine_.supply_pressure();
  }

  SrmdPlatenSettings settings_;
  sim::machine::PlatenRun machine_;
  std::array<bool, kAll> driven_{};
  sim::machine::PlatenReference held_;
  sim::machine::PlatenFeedback feedback_;
  double stopped_at_ = -1;
};

}  // namespace

std::unique_ptr<Adapter> make_srmd_platen(const SrmdPlatenSettings& settings) {
  return std::make_unique<SrmdPlaten>(settings);
}

}  // namespace rths::adapters

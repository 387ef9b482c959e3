// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/safe_machine.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

using controller::Safety;
using controller::SafetyCause;
using controller::SafetyFeedback;
using controller::SafetyState;
using controller::SafetyTrip;

enum MonitorWord : std::size_t { kState, kTrip, kAxis, kValue, kLimit, kMonitors };

class SafeMachine final : public Adapter {
 public:
  SafeMachine(std::unique_ptr<Adapter> machine, const SafeMachineSettings& settings)
      : machine_{std::move(machine)}, settings_{settings}, safety_{settings.safety} {
    std::vector<std::string> inputs, outputs;
    for (const auto& port : machine_->ports())
      (is_read(port) ? inputs : outputs).push_back(port.name);
    const auto find = [](const std::vector<std::string>& names, const std::string& name) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) throw Error{"safety: the machine has no word '" + name + "'"};
      return static_cast<std::size_t>(found - names.begin());
    };
    for (const auto& axis : settings.axes)
      words_.push_back({find(inputs, axis.reference), find(outputs, axis.displacement),
                        find(outputs, axis.force)});
    inputs_.resize(inputs.size());
    machine_outputs_ = outputs.size();
    commands_.resize(words_.size());
    feedback_.resize(words_.size());
    watched_.resize(settings.nodes.size());
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports = machine_->ports();
    ports.push_back({"safety.stop", Direction::Parameter, "1", 0, true, {{0, 1}}});
    for (const auto& node : settings_.nodes) {
      ports.push_back({"monitor." + node + ".host.step", Direction::Input, "1", 0, false});
      ports.push_back({"monitor." + node + ".host.invalid", Direction::Input, "1", 0, false});
    }
    ports.push_back({"safety.state", Direction::Monitor, "1", 0, true});
    ports.push_back({"safety.trip", Direction::Monitor, "1", 0, true});
    for (const char* name : {"safety.axis", "safety.value", "safety.limit"})
      ports.push_back({name, Direction::Monitor, "1", 0, false});
    return ports;
  }

  void activate() override { machine_->activate(); }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    // Until the machine's first step, the ring holds no measured force, with which the next could
    // be compared. So a test starts after it, also where the machine is late and all others have
    // stepped.
    const bool is_first = !is_enabled_;
    if (is_first) enable(step);
    const bool had_message = message_[0] != '\0';
    std::copy_n(step.inputs.begin(), inputs_.size(), inputs_.begin());
    for (std::size_t axis = 0; axis < words_.size(); ++axis)
      commands_[axis] = inputs_[words_[axis].reference];
    const bool all_stepped = watch(step) && !is_first;
    look_for_stops(step);
    const Status status = move(step, safety_.step(commands_, feedback_, all_stepped));
    write_monitors(step.outputs.subspan(machine_outputs_));
    if (status == Status::Fault) return status;
    if (safety_.has_tripped() && message_[0] == '\0') explain(step.time);
    if (message_[0] != '\0') step.message = message_.data();
    const SafetyState state = safety_.state();
    if (state == SafetyState::Off || state == SafetyState::Tripped) {
      if (had_message) return Status::Fault;
      if (message_[0] == '\0') return Status::Done;
    }
    return safety_.has_tripped() ? worst(status, Status::LimitExceeded) : status;
  }

  void deactivate() override { machine_->deactivate(); }

 private:
  /// Positions of an axis in the machine's inputs and outputs.
  struct Words {
    std::size_t reference, displacement, force;
  };
  struct Watched {
    double steps = 0, invalid = 0;
    std::size_t quiet = 0;  ///< periods of this machine without a step of the node
  };

  template <class... Values>
  void say(fmt::format_string<const Values&...> format, const Values&... values) noexcept {
    *fmt::format_to_n(message_.data(), message_.size() - 1, format, values...).out = '\0';
  }

  // A node that is late with this machine is not silent: missed steps are run afterwards.
  void watch(std::size_t node, double steps, double invalid, bool is_late) noexcept {
    Watched& watched = watched_[node];
    if (steps != watched.steps)
      watched.quiet = 0;
    else if (!is_late)
      ++watched.quiet;
    const double silence = static_cast<double>(watched.quiet) * settings_.safety.period;
    if (safety_.state() == SafetyState::Running) {
      if (invalid > watched.invalid) safety_.trip({SafetyCause::NodeInvalid, node, invalid, 0});
      if (silence > settings_.watchdog)
        safety_.trip({SafetyCause::NodeSilent, node, silence, settings_.watchdog});
    }
    watched.steps = steps;
    watched.invalid = invalid;
  }

  // Returns true if all nodes have stepped.
  [[nodiscard]] bool watch(const StepData& step) noexcept {
    const bool is_late = step.age >= settings_.safety.period;
    bool all_stepped = true;
    for (std::size_t node = 0; node < watched_.size(); ++node) {
      const double* words = &step.inputs[inputs_.size() + 1 + 2 * node];
      watch(node, words[0], words[1], is_late);
      all_stepped = all_stepped && words[0] > 0;
    }
    return all_stepped;
  }

  [[nodiscard]] Status move(StepData& step, std::span<const double> references) noexcept {
    for (std::size_t axis = 0; axis < words_.size(); ++axis)
      inputs_[words_[axis].reference] = references[axis];
    StepData inner = step;
    inner.inputs = inputs_;
    inner.outputs = step.outputs.first(machine_outputs_);
    inner.stopping = false;  // this layer brings the machine to rest
    const Status status = machine_->step(inner);
    for (std::size_t axis = 0; axis < words_.size(); ++axis)
      feedback_[axis] = {inner.outputs[words_[axis].displacement],
                         inner.outputs[words_[axis].force]};
    if (status == Status::Fault) step.message = inner.message;
    return status;
  }

  void write_monitors(std::span<double> outputs) const noexcept {
    const SafetyTrip& trip = safety_.first_trip();
    outputs[kState] = static_cast<double>(safety_.state());
    if (!safety_.has_tripped()) return;
    outputs[kTrip] = static_cast<double>(trip.cause);
    outputs[kAxis] = static_cast<double>(trip.axis);
    outputs[kValue] = std::isfinite(trip.value) ? trip.value : 0;  // the ring takes numbers only
    outputs[kLimit] = trip.limit;
  }

  void explain(double time) noexcept {
    const SafetyTrip& trip = safety_.first_trip();
    const auto [quantity, unit] = to_text(trip.cause);
    const bool is_node =
        trip.cause == SafetyCause::NodeSilent || trip.cause == SafetyCause::NodeInvalid;
    const std::string_view name =
        is_node ? settings_.nodes[trip.axis] : settings_.axes[trip.axis].name;
    if (trip.limit > 0)
      say("safety trip at {:.3f} s: {}: {} is {:.4g} {}, expected at most {:.4g} {}", time, name,
          quantity, trip.value, unit, trip.limit, unit);
    else
      say("safety trip at {:.3f} s: {}: {} is {:.4g}, expected {}", time, name, quantity,
          trip.value, std::isfinite(trip.value) ? "none" : "a number");
  }

  // The platen's position is its last word on the ring.
  void enable(const StepData& step) noexcept {
    for (std::size_t axis = 0; axis < words_.size(); ++axis) {
      commands_[axis] = step.outputs[words_[axis].displacement];
      feedback_[axis] = {commands_[axis], step.outputs[words_[axis].force]};
    }
    safety_.enable(commands_);
    is_enabled_ = true;
  }

  void look_for_stops(const StepData& step) noexcept {
    if (step.inputs[inputs_.size()] > 0 && !step.stopping && message_[0] == '\0') {
      safety_.stop();
      say("stopped by the operator at {:.3f} s", step.time);
    }
    if (step.stopping) safety_.stop();
  }

  std::unique_ptr<Adapter> machine_;
  SafeMachineSettings settings_;
  Safety safety_;
  std::size_t machine_outputs_ = 0;
  std::vector<Words> words_;
  std::vector<double> inputs_, commands_;  ///< inputs of the machine; wanted references
  std::vector<SafetyFeedback> feedback_;
  std::vector<Watched> watched_;
  bool is_enabled_ = false;
  std::array<char, 200> message_{};
};

}  // namespace

std::unique_ptr<Adapter> make_safe_machine(std::unique_ptr<Adapter> machine,
                                           const SafeMachineSettings& settings) {
  return std::make_unique<SafeMachine>(std::move(machine), settings);
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/echo.hpp>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/adapters/opf_layout.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {
namespace {

struct EchoSettings {
  OpfLayout layout;
  double stiffness = 1e6;  ///< of each axis [N/m, N·m/rad]
  /// atTarget stays 0 until the first target arrives, as with older controllers.
  bool is_down_when_idle = false;
  bool is_prompt = false;  ///< also steps on each write of the solver, not only on schedule
};

class Echo final : public Adapter {
 public:
  explicit Echo(EchoSettings settings)
      : settings_{std::move(settings)}, is_at_target_{!settings_.is_down_when_idle} {
    const auto& commands = settings_.layout.commands;
    for (const auto& feedback : settings_.layout.feedbacks) {
      const bool is_force = feedback.quantity == OpfQuantity::Force;
      const OpfSignal* command = OpfLayout::find(
          commands, feedback.axis, is_force ? OpfQuantity::Displacement : feedback.quantity);
      scalings_.push_back(
          {command == nullptr ? kNone : static_cast<std::size_t>(command - commands.data()),
           is_force ? settings_.stiffness : 1});
    }
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports{{"opf.newTarget", Direction::Input, "1", 0, false}};
    for (const auto& command : settings_.layout.commands)
      ports.push_back({command.name, Direction::Input, command.unit, 0, false});
    for (const auto& feedback : settings_.layout.feedbacks)
      ports.push_back({feedback.name, Direction::Output, feedback.unit, 0, false});
    ports.push_back({"daq.switchPC", Direction::Output, "1", 0, false});
    ports.push_back({"daq.atTarget", Direction::Output, "1", 0, false});
    return ports;
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const bool has_target = step.inputs[0] > 0;
    const auto commands = step.inputs.subspan(1);
    for (std::size_t i = 0; has_target && i < scalings_.size(); ++i)
      if (scalings_[i].command != kNone)
        step.outputs[i] = scalings_[i].factor * commands[scalings_[i].command];
    is_at_target_ = is_at_target_ || has_target;
    step.outputs[scalings_.size()] = has_target ? 1 : 0;
    step.outputs[scalings_.size() + 1] = is_at_target_ && !has_target ? 1 : 0;
    return step.stopping || step.inputs[0] < 0 ? Status::Done : Status::Ok;
  }

  [[nodiscard]] Wake wakes_on() const noexcept override {
    return settings_.is_prompt ? Wake::Inputs : Wake::None;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// A feedback is a command times a factor.
  struct Scaling {
    std::size_t command = kNone;
    double factor = 1;
  };

  EchoSettings settings_;
  std::vector<Scaling> scalings_;  ///< of each feedback
  bool is_at_target_;
};

}  // namespace

using namespace experiment;

NodeSettings read_echo(const std::string& /*node*/, const Config& table,
                       const Experiment& /*setup*/) {
  constexpr double kPeriod = 1e-3;  // [s]
  EchoSettings echo;
  echo.stiffness = table.number_in("stiffness_N_per_m", 0, 1e15, echo.stiffness);
  const Handshake handshake = read_handshake(table);
  if (handshake == Handshake::Numbered)
    table.fail("handshake", "handshake is 'numbered', expected at_target_first or target_first");
  echo.is_down_when_idle = handshake == Handshake::TargetFirst;
  echo.is_prompt = table.flag("prompt", false);
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod);
  settings.make = [echo](const Experiment&, const NodeContext& context) {
    EchoSettings complete = echo;
    complete.layout = opf_layout(context.map);
    return std::make_unique<Echo>(complete);
  };
  return settings;
}

}  // namespace rths::adapters

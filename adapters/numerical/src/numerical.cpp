// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/numerical.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/computing_times.hpp>

#include "solution.hpp"

namespace rths::adapters {

using experiment::ComputingTimes;

namespace {

constexpr double kEndOfRun = 1e-9;  // [s], rounding of step counts times step length

class Numerical final : public Adapter {
 public:
  explicit Numerical(const NumericalSettings& settings);
  [[nodiscard]] std::vector<Port> ports() const override;
  void activate() override {}
  [[nodiscard]] Status step(StepData& step) noexcept override;
  void deactivate() noexcept override {}

 private:
  // Positions among the inputs; a flag precedes the values that it guards.
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };

  // Positions among the outputs: displacement and velocity of each axis, vertical force (optional),
  // time. newTarget is last, after the values that it guards.
  [[nodiscard]] std::size_t vertical_at() const noexcept { return 2 * axes_; }
  [[nodiscard]] std::size_t time_at() const noexcept { return 2 * axes_ + (is_vertical_ ? 1 : 0); }
  [[nodiscard]] std::size_t new_target_at() const noexcept { return time_at() + 1; }

  [[nodiscard]] Status advance(const StepData& step) noexcept;
  void at_target(const StepData& step) noexcept;
  void acquire(const StepData& step) noexcept;
  void post(const StepData& step) noexcept;
  void write_monitors(const StepData& step) const noexcept;

  NumericalSettings settings_;
  std::size_t axes_;
  bool is_vertical_;                      ///< the vertical load varies
  bool reads_vertical_;                   ///< the measured vertical force is fed back
  std::vector<Eigen::Index> directions_;  ///< of each tested axis: 0 long, 1 lat
  Solution solution_;
  Exchange exchange_;
  std::optional<ComputingTimes> computing_times_;
  OpfHandshake handshake_;
  bool is_computing_ = false;
  double acquired_ = 0;        ///< start of the computation [s]
  double computing_time_ = 0;  ///< of the current step [s]
  std::uint64_t steps_ = 0;
};

Numerical::Numerical(const NumericalSettings& settings)
    : settings_{settings},
      axes_{settings.axes.size()},
      is_vertical_{!settings.history &&
                   (!settings.motion.vert_acceleration.empty() || settings.plant.overturns())},
      reads_vertical_{settings.vertical_feedback == sim::VerticalFeedback::Measured},
      solution_{make_solution(settings)},
      handshake_{settings.wait_deadline, settings.handshake} {
  if (reads_vertical_ && !is_vertical_ && !settings.history)
    throw Error{
        "numerical: vertical_feedback is measured, but the vertical load is constant, expected a "
        "motion with a vertical component, or a bearing off the centre"};
  if (settings.computing_time) computing_times_.emplace(*settings.computing_time);
  for (const auto& axis : settings.axes) {
    if (axis != "long" && axis != "lat")
      throw Error{"numerical: axis '" + axis + "' is not in the model, expected long or lat"};
    directions_.push_back(axis == "long" ? 0 : 1);
  }
}

std::vector<Port> Numerical::ports() const {
  std::vector<Port> ports;
  const auto add = [&](const std::string& name, Direction direction, const std::string& unit) {
    ports.push_back({name, direction, unit, 0, false});
  };
  add("daq.atTarget", Direction::Input, "1");
  add("daq.switchPC", Direction::Input, "1");
  for (const auto& axis : settings_.axes) add("daq." + axis + ".force.fbk", Direction::Input, "N");
  if (reads_vertical_) add("daq.vert.force.fbk", Direction::Input, "N");
  for (const auto& axis : settings_.axes) {
    add("opf." + axis + ".displ.target", Direction::Output, "m");
    add("opf." + axis + ".veloc.target", Direction::Output, "m/s");
  }
  if (is_vertical_) add("opf.vert.force.target", Direction::Output, "N");
  add("opf.1.time.target", Direction::Output, "s");
  add("opf.newTarget", Direction::Output, "1");
  add("step", Direction::Monitor, "1");
  add("computing_time", Direction::Monitor, "s");
  std::visit(
      [&](const auto& solution) {
        for (const auto& [name, unit] : solution.monitors()) add(name, Direction::Monitor, unit);
      },
      solution_);
  return ports;
}

// The specimen is at its target: finish the step with its force and begin the next one.
void Numerical::acquire(const StepData& step) noexcept {
  for (std::size_t i = 0; i < axes_; ++i)
    exchange_.force[directions_[i]] = step.inputs[kFeedback + i];
  if (reads_vertical_) exchange_.measured_vertical_force = step.inputs[kFeedback + axes_];
  std::visit(
      [&](auto& solution) {
        if (steps_ > 0) solution.finish(exchange_);
        write_monitors(step);
        solution.begin(exchange_);
      },
      solution_);
  computing_time_ = computing_times_ ? computing_times_->draw() : 0;
}

void Numerical::post(const StepData& step) noexcept {
  ++steps_;
  for (std::size_t i = 0; i < axes_; ++i) {
    step.outputs[2 * i] = exchange_.displacement[directions_[i]];
    step.outputs[2 * i + 1] = exchange_.velocity[directions_[i]];
  }
  if (is_vertical_) step.outputs[vertical_at()] = exchange_.vertical_force;
  step.outputs[time_at()] = std::visit([](const auto& s) { return s.time(); }, solution_);
  handshake_.post(step.time);
}

void Numerical::write_monitors(const StepData& step) const noexcept {
  const auto monitors = step.outputs.subspan(new_target_at() + 1);
  monitors[0] = static_cast<double>(steps_);
  monitors[1] = computing_time_;
  std::visit([&](const auto& solution) { solution.monitor(monitors.subspan(2)); }, solution_);
}

void Numerical::at_target(const StepData& step) noexcept {
  acquire(step);
  acquired_ = step.time;
  const double steps_done = static_cast<double>(steps_) * settings_.integration_step;
  if (steps_done >= settings_.duration - kEndOfRun)
    handshake_.stop(step.time);
  else if (settings_.computing_time)
    is_computing_ = true;
  else
    post(step);
}

Status Numerical::advance(const StepData& step) noexcept {
  if (step.stopping && !handshake_.is_stopping()) handshake_.stop(step.time);
  if (handshake_.is_stopping())
    return handshake_.has_stopped(step.time) ? Status::Done : Status::Ok;
  if (steps_ == 0 && step.time < settings_.rest) {
    handshake_.restart_deadline(step.time);
    return Status::Ok;
  }
  if (is_computing_) {
    if (step.time - acquired_ < computing_time_) return Status::Ok;
    is_computing_ = false;
    post(step);
    return Status::Ok;
  }
  const Status status =
      handshake_.update(step.inputs[kAtTarget] > 0, step.inputs[kSwitchPc] > 0, step.time);
  if (handshake_.is_ready()) at_target(step);
  return status;
}

Status Numerical::step(StepData& step) noexcept {
  const Status status = advance(step);
  step.outputs[new_target_at()] = handshake_.new_target();
  step.message = handshake_.message();
  return status;
}

}  // namespace

std::unique_ptr<Adapter> make_numerical(const NumericalSettings& settings) {
  return std::make_unique<Numerical>(settings);
}

}  // namespace rths::adapters

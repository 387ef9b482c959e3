// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/numerical.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/parts.hpp>

#include "substructures.hpp"

namespace rths::adapters {

using experiment::ComputingTimes;

namespace {

constexpr std::size_t kVertical = 2;  // in the interface of the plant
constexpr double kEndOfRun = 1e-9;    // [s], rounding of step counts times step length

class Numerical final : public Adapter {
 public:
  explicit Numerical(const NumericalSettings& settings);
  [[nodiscard]] std::vector<Port> ports() const override;
  [[nodiscard]] Status step(StepData& step) noexcept override;

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
  bool is_vertical_;     ///< the vertical load varies
  bool reads_vertical_;  ///< the measured vertical force is fed back
  std::unique_ptr<sim::Substructure> substructure_;
  std::vector<std::size_t> places_;            ///< of each tested axis in the interface
  std::vector<double> target_, rate_, force_;  ///< of the interface; untested axes have no force
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
      substructure_{make_substructure(settings)},
      handshake_{settings.wait_deadline, settings.handshake} {
  if (reads_vertical_ && !is_vertical_ && !settings.history)
    throw Error{
        "numerical: vertical_feedback is measured, but the vertical load is constant, expected a "
        "motion with a vertical component, or a bearing off the centre"};
  if (settings.computing_time) computing_times_.emplace(*settings.computing_time);
  const auto interface = substructure_->interface();
  for (const auto& axis : settings.axes) {
    const auto dof = std::find_if(interface.begin(), interface.end(), [&](const auto& one) {
      return one.name == axis && one.controlled == sim::Controlled::Displacement;
    });
    if (dof == interface.end())
      throw Error{"numerical: axis '" + axis + "' is not in the model, expected long or lat"};
    places_.push_back(static_cast<std::size_t>(dof - interface.begin()));
  }
  for (auto* values : {&target_, &rate_, &force_}) values->resize(interface.size());
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
  for (const auto& [name, unit] : substructure_->monitors()) add(name, Direction::Monitor, unit);
  return ports;
}

// The specimen is at its target: finish the step with its force and begin the next one.
void Numerical::acquire(const StepData& step) noexcept {
  for (std::size_t i = 0; i < axes_; ++i) force_[places_[i]] = step.inputs[kFeedback + i];
  if (reads_vertical_) force_[kVertical] = step.inputs[kFeedback + axes_];
  if (steps_ > 0) substructure_->correct(force_);
  write_monitors(step);
  substructure_->predict(target_, rate_);
  computing_time_ = computing_times_ ? computing_times_->draw() : 0;
}

void Numerical::post(const StepData& step) noexcept {
  ++steps_;
  for (std::size_t i = 0; i < axes_; ++i) {
    step.outputs[2 * i] = target_[places_[i]];
    step.outputs[2 * i + 1] = rate_[places_[i]];
  }
  if (is_vertical_) step.outputs[vertical_at()] = target_[kVertical];
  step.outputs[time_at()] = substructure_->time();
  handshake_.post(step.time);
}

void Numerical::write_monitors(const StepData& step) const noexcept {
  const auto monitors = step.outputs.subspan(new_target_at() + 1);
  monitors[0] = static_cast<double>(steps_);
  monitors[1] = computing_time_;
  substructure_->monitor(monitors.subspan(2));
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

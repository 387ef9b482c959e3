// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/numerical.hpp>

#include <algorithm>

#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::adapters {

using experiment::ComputingTimes;

namespace {

constexpr double kPeriod = 0.25e-3, kPhase = 0.1e-3;  // [s]

sim::VerticalFeedback read_vertical_feedback(const Config& table) {
  const std::string source = table.text("vertical_feedback", "model");
  if (source == "model") return sim::VerticalFeedback::Model;
  if (source != "measured")
    table.fail("vertical_feedback",
               "vertical_feedback is '" + source + "', expected model or measured");
  return sim::VerticalFeedback::Measured;
}

/// Targets from a displacement history, independent of the specimen's force.
class PlayedTargets final : public sim::Substructure {
 public:
  PlayedTargets(const experiment::DisplacementHistory& history, double integration_step)
      : history_{history}, integration_step_{integration_step} {
    if (!(history_.time_step > 0) || history_.displacement_long.size() < 2 ||
        history_.displacement_long.size() != history_.displacement_lat.size())
      throw Error{"displacement history: expected a time step and two equally long axes"};
  }

  [[nodiscard]] std::vector<sim::InterfaceDof> interface() const override {
    return sim::plant_interface();
  }
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override {
    const Eigen::Vector2d before = at(time());
    ++step_;
    const Eigen::Vector2d now = at(time()), velocity = (now - before) / integration_step_;
    for (Eigen::Index i = 0; i < 2; ++i) {
      target[static_cast<std::size_t>(i)] = now[i];
      rate[static_cast<std::size_t>(i)] = velocity[i];
    }
    target[2] = rate[2] = 0;
  }
  void correct(std::span<const double> /*force*/) RTHS_REALTIME override {}
  [[nodiscard]] double time() const RTHS_REALTIME override {
    return static_cast<double>(step_) * integration_step_;
  }

 private:
  // Linear between samples; constant after the last.
  [[nodiscard]] Eigen::Vector2d at(double time) const noexcept {
    const double last = static_cast<double>(history_.displacement_long.size() - 1);
    const double position = std::clamp(time / history_.time_step, 0.0, last);
    const auto i =
        std::min(static_cast<std::size_t>(position), history_.displacement_long.size() - 2);
    const double fraction = position - static_cast<double>(i);
    const auto between = [&](const std::vector<double>& values) {
      return (1 - fraction) * values[i] + fraction * values[i + 1];
    };
    return {between(history_.displacement_long), between(history_.displacement_lat)};
  }

  experiment::DisplacementHistory history_;
  double integration_step_;
  std::size_t step_ = 0;
};

/// What computes the targets: the plant of the settings, or their displacement history. Both have
/// the interface of the plant.
/// @throws Error if the model cannot be assembled, or the history is not one   @setup
std::unique_ptr<sim::Substructure> make_substructure(const NumericalSettings& settings) {
  if (settings.history)
    return std::make_unique<PlayedTargets>(*settings.history, settings.integration_step);
  return settings.structure->analysis(
      {settings.motion.along(horizontal_among(settings.axes)), settings.bearing_initial_stiffness,
       settings.integration_step, settings.alpha, settings.vertical_feedback, settings.substeps});
}

constexpr std::size_t kVertical = 2;  // in the interface of the plant
constexpr double kEndOfRun = 1e-9;    // [s], rounding of step counts times step length

class Numerical final : public Adapter {
 public:
  explicit Numerical(const NumericalSettings& settings)
      : settings_{settings},
        axes_{settings.axes.size()},
        is_vertical_{!settings.history && (!settings.motion.vert_acceleration.empty() ||
                                           settings.structure->overturns())},
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

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    const auto add = [&](const std::string& name, Direction direction, const std::string& unit) {
      ports.push_back({name, direction, unit, 0, false});
    };
    add("daq.atTarget", Direction::Input, "1");
    add("daq.switchPC", Direction::Input, "1");
    for (const auto& axis : settings_.axes)
      add("daq." + axis + ".force.fbk", Direction::Input, "N");
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

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const Status status = advance(step);
    step.outputs[new_target_at()] = handshake_.new_target();
    step.message = handshake_.message();
    return status;
  }

 private:
  // Positions among the inputs; a flag precedes the values that it guards.
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };

  // Positions among the outputs: displacement and velocity of each axis, vertical force (optional),
  // time. newTarget is last, after the values that it guards.
  [[nodiscard]] std::size_t vertical_at() const noexcept { return 2 * axes_; }
  [[nodiscard]] std::size_t time_at() const noexcept { return 2 * axes_ + (is_vertical_ ? 1 : 0); }
  [[nodiscard]] std::size_t new_target_at() const noexcept { return time_at() + 1; }

  [[nodiscard]] Status advance(const StepData& step) noexcept {
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
    substructure_->work_ahead();  // the machine moves meanwhile
    const Status status =
        handshake_.update(step.inputs[kAtTarget], step.inputs[kSwitchPc], step.time);
    if (handshake_.is_ready()) at_target(step);
    return status;
  }

  void at_target(const StepData& step) noexcept {
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

  // The specimen is at its target: finish the step with its force and begin the next one.
  void acquire(const StepData& step) noexcept {
    for (std::size_t i = 0; i < axes_; ++i) force_[places_[i]] = step.inputs[kFeedback + i];
    if (reads_vertical_) force_[kVertical] = step.inputs[kFeedback + axes_];
    if (steps_ > 0) substructure_->correct(force_);
    write_monitors(step);
    substructure_->predict(target_, rate_);
    computing_time_ = computing_times_ ? computing_times_->draw() : 0;
  }

  void post(const StepData& step) noexcept {
    ++steps_;
    for (std::size_t i = 0; i < axes_; ++i) {
      step.outputs[2 * i] = target_[places_[i]];
      step.outputs[2 * i + 1] = rate_[places_[i]];
    }
    if (is_vertical_) step.outputs[vertical_at()] = target_[kVertical];
    step.outputs[time_at()] = substructure_->time();
    handshake_.post(step.time);
  }

  void write_monitors(const StepData& step) const noexcept {
    const auto monitors = step.outputs.subspan(new_target_at() + 1);
    monitors[0] = static_cast<double>(steps_);
    monitors[1] = computing_time_;
    substructure_->monitor(monitors.subspan(2));
  }

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

}  // namespace

std::unique_ptr<Adapter> make_numerical(const NumericalSettings& settings) {
  return std::make_unique<Numerical>(settings);
}

using namespace experiment;

std::unique_ptr<Adapter> make_numerical_node(const Experiment& setup, const NodeContext& context,
                                             Handshake handshake, sim::VerticalFeedback vertical) {
  NumericalSettings settings;
  settings.handshake = handshake;
  settings.axes = setup.axes;
  settings.structure = setup.plant.structure;
  settings.motion = setup.earthquake.motion;
  settings.bearing_initial_stiffness = sim::initial_stiffness(setup.model.bearing);
  settings.integration_step = setup.time.integration_step;
  settings.alpha = setup.solver.alpha;
  settings.substeps = setup.solver.substeps;
  settings.duration = setup.time.duration;
  settings.rest = setup.time.rest;
  settings.wait_deadline = setup.solver.wait_deadline * setup.time.rate;
  if (context.is_virtual || setup.solver.models_computing_time)
    settings.computing_time = setup.solver.computing_time;
  settings.history = setup.history;
  settings.vertical_feedback = vertical;
  return make_numerical(settings);
}

// Polls its flags four times per millisecond.
NodeSettings read_numerical(const std::string& /*node*/, const Config& table,
                            const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Solver;
  settings.schedule = schedule_of(kPeriod, kPhase, MissedSteps::Skip);
  settings.priority = 40;
  settings.solver.integrates_plant = true;
  settings.solver.has_computing_time = settings.solver.waits_for_flags = true;
  const Handshake handshake = read_handshake(table);
  settings.solver.ticks_per_target = ticks_per_target(handshake);
  settings.make = [handshake, vertical = read_vertical_feedback(table)](
                      const Experiment& setup, const NodeContext& context) {
    return make_numerical_node(setup, context, handshake, vertical);
  };
  return settings;
}

}  // namespace rths::adapters

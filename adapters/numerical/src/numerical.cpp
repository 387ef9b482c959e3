// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/numerical.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include <rths/core/error.hpp>

#include "solution.hpp"

namespace rths::adapters {
namespace {

constexpr double kFarewell = 0.02;  // [s] that newTarget stays at stop
constexpr double kNew = 1;          // values of newTarget
constexpr double kIdle = 0;
constexpr double kStop = -1;
constexpr double kEndOfRun = 1e-9;  // [s], rounding of step counts times step length

// What the solver waits for: one state per line of the handshake.
enum class Phase { WaitForTarget, Compute, WaitForSwitch, WaitForRelease, Leave };

class Numerical final : public Adapter {
 public:
  explicit Numerical(const NumericalSettings& settings);
  [[nodiscard]] std::vector<Port> ports() const override;
  void activate() override {}
  [[nodiscard]] Status step(Step& step) noexcept override;
  void deactivate() noexcept override {}

 private:
  // Positions among the inputs; the flags come before what they guard.
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };

  // Positions among the outputs: displacement and velocity of each axis, the vertical force if
  // there is one, time; newTarget comes last, after what it guards.
  [[nodiscard]] std::size_t vertical_at() const noexcept { return 2 * axes_; }
  [[nodiscard]] std::size_t time_at() const noexcept { return 2 * axes_ + (is_vertical_ ? 1 : 0); }
  [[nodiscard]] std::size_t new_target_at() const noexcept { return time_at() + 1; }

  void enter(Phase phase, const Step& step, double new_target) noexcept;
  [[nodiscard]] Status wait_for(bool flag, Step& step, const char* otherwise) noexcept;
  [[nodiscard]] Status at_target(Step& step) noexcept;
  void acquire(const Step& step) noexcept;
  void post(const Step& step) noexcept;
  void write_monitors(const Step& step) const noexcept;
  [[nodiscard]] double draw_computing_time() noexcept;

  NumericalSettings settings_;
  std::size_t axes_;
  bool is_vertical_;                      ///< the motion is
  std::vector<Eigen::Index> directions_;  ///< of each tested axis: 0 long, 1 lat
  Solution solution_;
  Exchange exchange_;
  std::mt19937_64 random_;
  Phase phase_ = Phase::WaitForTarget;
  double entered_ = 0;         ///< when the phase began [s]
  double computing_time_ = 0;  ///< of the step in hand [s]
  std::uint64_t steps_ = 0;
};

Numerical::Numerical(const NumericalSettings& settings)
    : settings_{settings},
      axes_{settings.axes.size()},
      is_vertical_{!settings.history && !settings.motion.vert_acceleration.empty()},
      solution_{make_solution(settings)},
      random_{settings.computing_time ? settings.computing_time->seed : 0} {
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

void Numerical::enter(Phase phase, const Step& step, double new_target) noexcept {
  phase_ = phase;
  entered_ = step.time;
  step.outputs[new_target_at()] = new_target;
}

Status Numerical::wait_for(bool flag, Step& step, const char* otherwise) noexcept {
  if (flag || step.time - entered_ <= settings_.wait_deadline) return Status::Ok;
  step.message = otherwise;
  return Status::Fault;
}

double Numerical::draw_computing_time() noexcept {
  if (!settings_.computing_time) return 0;
  const ComputingTime& model = *settings_.computing_time;
  std::normal_distribution<double> normal{model.mean, model.spread * model.mean};
  std::uniform_real_distribution<double> uniform{0, 1};
  const double usual = std::clamp(normal(random_), 0.0, 2 * model.mean);
  return usual + (uniform(random_) < model.overrun_fraction ? model.overrun : 0);
}

// The specimen has arrived: finish the step with its force and begin the next one.
void Numerical::acquire(const Step& step) noexcept {
  for (std::size_t i = 0; i < axes_; ++i)
    exchange_.force[directions_[i]] = step.inputs[kFeedback + i];
  std::visit(
      [&](auto& solution) {
        if (steps_ > 0) solution.finish(exchange_);
        write_monitors(step);
        solution.begin(exchange_);
      },
      solution_);
  computing_time_ = draw_computing_time();
}

void Numerical::post(const Step& step) noexcept {
  ++steps_;
  for (std::size_t i = 0; i < axes_; ++i) {
    step.outputs[2 * i] = exchange_.displacement[directions_[i]];
    step.outputs[2 * i + 1] = exchange_.velocity[directions_[i]];
  }
  if (is_vertical_) step.outputs[vertical_at()] = exchange_.vertical_force;
  step.outputs[time_at()] = std::visit([](const auto& s) { return s.time(); }, solution_);
  enter(Phase::WaitForSwitch, step, kNew);
}

void Numerical::write_monitors(const Step& step) const noexcept {
  const auto monitors = step.outputs.subspan(new_target_at() + 1);
  monitors[0] = static_cast<double>(steps_);
  monitors[1] = computing_time_;
  std::visit([&](const auto& solution) { solution.monitor(monitors.subspan(2)); }, solution_);
}

Status Numerical::at_target(Step& step) noexcept {
  if (!(step.inputs[kAtTarget] > 0))
    return wait_for(false, step, "atTarget did not rise before the deadline");
  acquire(step);
  const double steps_done = static_cast<double>(steps_) * settings_.integration_step;
  if (steps_done >= settings_.duration - kEndOfRun)
    enter(Phase::Leave, step, kStop);
  else if (settings_.computing_time)
    enter(Phase::Compute, step, kIdle);
  else
    post(step);
  return Status::Ok;
}

Status Numerical::step(Step& step) noexcept {
  if (step.stopping && phase_ != Phase::Leave) enter(Phase::Leave, step, kStop);
  if (steps_ == 0 && !step.stopping && step.time < settings_.rest) {
    entered_ = step.time;
    return Status::Ok;
  }
  const bool switch_pc = step.inputs[kSwitchPc] > 0;
  switch (phase_) {
    case Phase::WaitForTarget:
      return at_target(step);
    case Phase::Compute:
      if (step.time - entered_ >= computing_time_) post(step);
      return Status::Ok;
    case Phase::WaitForSwitch:
      if (switch_pc) enter(Phase::WaitForRelease, step, kIdle);
      return wait_for(switch_pc, step, "switchPC did not rise before the deadline");
    case Phase::WaitForRelease:
      if (!switch_pc) enter(Phase::WaitForTarget, step, kIdle);
      return wait_for(!switch_pc, step, "switchPC did not fall before the deadline");
    case Phase::Leave:
      return step.time - entered_ < kFarewell ? Status::Ok : Status::Done;
  }
  return Status::Fault;
}

}  // namespace

std::unique_ptr<Adapter> make_numerical(const NumericalSettings& settings) {
  return std::make_unique<Numerical>(settings);
}

}  // namespace rths::adapters

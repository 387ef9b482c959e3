// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/closed_loop.hpp>

#include <algorithm>
#include <cmath>

namespace rths::loop {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Index index(std::size_t i) { return static_cast<Index>(i); }

std::size_t displacements_of(const sim::Substructure& substructure) {
  const auto interface = substructure.interface();
  return static_cast<std::size_t>(std::ranges::count_if(
      interface, [](const auto& dof) { return dof.controlled == sim::Controlled::Displacement; }));
}

std::vector<int> delays_of(const CommandPath& path, std::size_t axes) {
  return path.sampling_delay.empty() ? std::vector<int>(axes, 0) : path.sampling_delay;
}

}  // namespace

ClosedLoop::Path::Path(const CommandPath& path, std::size_t axes, double period)
    : command{path.settings},
      exchange{delays_of(path, axes), path.settings},
      substeps{std::max(
          1L, std::lround(path.settings.substeps * period / path.settings.simulation_step))},
      is_force_ahead{path.is_force_ahead} {}

// A target that is reached in its period moves the machine in the same tick.
ClosedLoop::ClosedLoop(sim::Substructure& substructure, TransferSystem& transfer,
                       const ClosedLoopSettings& settings)
    : substructure_{substructure},
      transfer_{transfer},
      settings_{settings},
      interface_{substructure.interface().size()},
      axes_{displacements_of(substructure)},
      forces_{VectorXd::Zero(index(interface_ - axes_))},
      arrived_forces_{forces_},
      arrived_{VectorXd::Zero(index(axes_))},
      sent_{arrived_, arrived_, arrived_, {}},
      all_(interface_),
      rates_(interface_),
      tick_{settings.path ? 0 : settings.host.first_target + 1},
      first_tick_{tick_},
      machine_tick_{tick_ == 0 ? 0 : settings.host.order.machine_ticks(tick_)},
      arrival_{settings.host.first_arrival()} {
  target_ = setpoint_ = {arrived_, arrived_, arrived_};
  if (!settings.path) return;
  path_.emplace(*settings.path, axes_, settings.period);
  predict();
  if (settings.targets_act_early) setpoint_ = target_;
}

void ClosedLoop::tick() {
  if (path_)
    follow_path();
  else
    follow_targets();
  ++tick_;
}

void ClosedLoop::predict() {
  substructure_.predict(all_, rates_);
  for (std::size_t i = 0; i < axes_; ++i) {
    const bool is_tested = settings_.tested.empty() || settings_.tested[i];
    target_.displacement[index(i)] = is_tested ? all_[i] : 0;
    target_.velocity[index(i)] = is_tested ? rates_[i] : 0;
  }
  for (std::size_t i = axes_; i < interface_; ++i) forces_[index(i - axes_)] = all_[i];
}

// A controlled force is exactly its target.
void ClosedLoop::correct(const VectorXd& force) {
  for (std::size_t i = 0; i < axes_; ++i) all_[i] = force[index(i)];
  for (std::size_t i = axes_; i < interface_; ++i) all_[i] = forces_[index(i - axes_)];
  substructure_.correct(all_);
  ++steps_;
}

// Moves the machine until the controller reads its feedback in a tick.
void ClosedLoop::move_until(std::size_t controller_tick) {
  const TickOrder& order = settings_.host.order;
  for (; machine_tick_ < order.machine_ticks(controller_tick); ++machine_tick_) {
    const std::size_t sent = order.controller_ticks(machine_tick_);
    transfer_.move(sent - std::min(sent, first_tick_),
                   settings_.targets_act_early ? forces_ : arrived_forces_);
  }
}

void ClosedLoop::follow_path() {
  move_until(tick_);
  const bool waits = settings_.host.order.is_missed(tick_);
  if (waits && tick_ == arrival_) ++arrival_;
  const bool arrives = tick_ == arrival_;
  if (arrives) {
    setpoint_ = target_;
    arrived_ = target_.displacement;
    arrived_forces_ = forces_;
    is_under_way_ = true;
    ++targets_;
  }
  transfer_.measure(arrived_, sent_);
  const double number = 1 + static_cast<double>(targets_ % 2);  // targets of adjacent ticks differ
  for (long i = 0; i < path_->substeps; ++i) {
    if (waits) {
      path_->command.wait();
      continue;
    }
    const bool is_new = path_->exchange.begin(arrives ? number : 0);
    path_->command.substep(is_new, setpoint_);
    path_->exchange.end(path_->command, transfer_.displacement(), transfer_.force());
  }
  send();
  if (is_under_way_ && path_->exchange.at_target()) end_step();
}

void ClosedLoop::send() {
  sent_.displacement = path_->command.command();
  sent_.velocity = path_->command.command_velocity();
  sent_.acceleration = path_->command.command_acceleration();
  sent_.pace = path_->pace(path_->command.lost_time(), settings_.period, path_->is_force_ahead);
  transfer_.send(tick_, sent_);
}

void ClosedLoop::end_step() {
  is_under_way_ = false;
  correct(path_->exchange.held_force());
  arrival_ = settings_.host.arrival(targets_, tick_);
  predict();
}

void ClosedLoop::follow_targets() {
  predict();
  arrived_ = target_.displacement;
  arrived_forces_ = forces_;
  ++targets_;
  sent_.displacement = arrived_;
  sent_.acceleration = (target_.velocity / settings_.rate - sent_.velocity) / settings_.period;
  sent_.velocity = target_.velocity / settings_.rate;
  transfer_.send(tick_, sent_);
  move_until(tick_ + 1);
  transfer_.measure(arrived_, sent_);
  correct(transfer_.force());
}

}  // namespace rths::loop

// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/perfect_machine.hpp>

namespace rths::loop {

using Eigen::Vector2d;

PerfectMachine::PerfectMachine(const sim::Bearing& bearing, double period, int pieces)
    : specimen_{bearing, period / pieces},
      axial_load_{bearing.axial_load},
      period_{period},
      pieces_{pieces} {}

void PerfectMachine::send(std::size_t /*controller_tick*/, const Command& command) {
  to_ = command.displacement;
  velocity_ = command.velocity;
}

void PerfectMachine::move(std::size_t /*found*/, const Eigen::VectorXd& forces) {
  const double load = axial_load_ + forces[0];
  const Vector2d at = displacement_;
  if (pieces_ == 1) {
    force_ = specimen_.advance(to_, velocity_, load);
  } else {
    const Vector2d velocity = (to_ - at) / period_;
    for (int k = 1; k <= pieces_; ++k)
      force_ = specimen_.advance(at + (to_ - at) * k / pieces_, velocity, load);
  }
  displacement_ = to_;
}

}  // namespace rths::loop

// SPDX-License-Identifier: Apache-2.0
#include "sent_compensation.hpp"

#include <algorithm>

namespace rths::budget {
namespace {

template <class Value>
const Value& at(const std::vector<Value>& by_tick, std::size_t tick) {
  return by_tick[std::min(tick, by_tick.size() - 1)];
}

}  // namespace

SentCompensation::SentCompensation(const HybridTest& test) : test_{test} {
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    if (const auto* sent = std::get_if<SentInverse>(&test.compensation[i]))
      inverse_[i].emplace(sent->settings);
}

Eigen::Vector2d SentCompensation::operator()(std::size_t tick, const loop::Command& command,
                                             const Eigen::Vector2d& force) {
  return {reference_of(0, tick, command, force[0]), reference_of(1, tick, command, force[1])};
}

double SentCompensation::reference_of(std::size_t axis, std::size_t tick,
                                      const loop::Command& command, double force) {
  const auto i = static_cast<Eigen::Index>(axis);
  const double x = command.displacement[i];
  if (const auto* sent = std::get_if<SentInverse>(&test_.compensation[axis])) {
    inverse_[axis]->advance(x, force, command.pace);
    return inverse_[axis]->reference(at(sent->coefficients, tick), 1);
  }
  const auto& sent = std::get<std::vector<Lead>>(test_.compensation[axis]);
  if (sent.empty()) return x;
  const Lead& lead = at(sent, tick);
  return lead[0] * x + lead[1] * command.velocity[i] + lead[2] * command.acceleration[i];
}

}  // namespace rths::budget

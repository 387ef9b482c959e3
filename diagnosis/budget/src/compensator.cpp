// SPDX-License-Identifier: Apache-2.0
#include "compensator.hpp"

#include <algorithm>
#include <utility>

namespace rths::budget {
namespace {

template <class Value>
const Value& at(const std::vector<Value>& by_tick, std::size_t tick) {
  return by_tick[std::min(tick, by_tick.size() - 1)];
}

}  // namespace

Compensator::Compensator(const HybridTest& test, bool acts) : test_{test}, acts_{acts} {
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    if (const auto* sent = std::get_if<SentInverse>(&test.compensation[i]))
      inverse_[i].emplace(sent->settings);
}

Eigen::Vector2d Compensator::operator()(std::size_t tick, const Command& command,
                                        const Eigen::Vector2d& force) {
  if (!acts_) return command.displacement;
  return {reference_of(0, tick, command, force[0]), reference_of(1, tick, command, force[1])};
}

double Compensator::reference_of(std::size_t axis, std::size_t tick, const Command& command,
                                 double force) {
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

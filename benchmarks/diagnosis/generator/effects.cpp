// SPDX-License-Identifier: Apache-2.0
#include "effects.hpp"

#include <stdexcept>
#include <string>

namespace trial {
namespace {

std::vector<Effect> collect() {
  std::vector<Effect> all;
  for (const auto& group : {bearing_effects(), machine_effects(), force_sensor_effects(),
                            other_sensor_effects(), actuator_effects(), outside_effects()})
    all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace

const std::vector<Effect>& effects() {
  static const std::vector<Effect> all = collect();
  return all;
}

const Effect& effect(std::string_view name) {
  for (const Effect& candidate : effects())
    if (candidate.name == name) return candidate;
  throw std::invalid_argument("there is no effect named " + std::string(name));
}

void add(const Effect& effect, double size, Random& random, Physics& physics) {
  for (const Draw& draw : effect.draws) {
    const double without = info(draw.parameter).absent;
    double value = random.uniform(draw.low, draw.high);
    if (draw.either_sign && random.coin()) value = -value;
    physics[draw.parameter] = draw.is_size ? without + size * (value - without) : value;
  }
}

void remove(const Effect& effect, Physics& physics) {
  for (const Draw& draw : effect.draws)
    if (draw.is_size) physics[draw.parameter] = info(draw.parameter).absent;
}

}  // namespace trial

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

#include "kinds.hpp"

namespace rths::sim {
namespace {

template <class... Files>
std::vector<TermKind> joined(const Files&... files) {
  std::vector<TermKind> kinds;
  (kinds.insert(kinds.end(), files.begin(), files.end()), ...);
  return kinds;
}

// Within a stage, terms act in the order of these files and of the kinds in each.
std::vector<TermKind> all_kinds() {
  auto kinds =
      joined(actuator_kinds(), elastomeric_vertical_kinds(), elastomeric_modifier_kinds(),
             lead_heating_kinds(), elastomeric_restoring_kinds(), bouc_wen_kinds(),
             hysteresis_kinds(), controlled_kinds(), sliding_vertical_kinds(),
             sliding_modifier_kinds(), slider_kinds(), triple_pendulum_kinds(), stop_kinds(),
             mount_kinds(), spring_kinds(), friction_kinds(), sensor_kinds());
  std::ranges::stable_sort(kinds, [](const auto& a, const auto& b) { return a.stage < b.stage; });
  return kinds;
}

}  // namespace

std::span<const TermKind> catalogue() {
  static const std::vector<TermKind> kinds = all_kinds();
  return kinds;
}

const TermKind& term_kind(std::string_view name) {
  const auto kinds = catalogue();
  const auto found =
      std::ranges::find_if(kinds, [&](const auto& kind) { return kind.name == name; });
  if (found != kinds.end()) return *found;
  std::vector<std::string> known;
  for (const auto& kind : kinds) known.emplace_back(kind.name);
  throw Error{"there is no term '" + std::string{name} + "'" +
              did_you_mean(std::string{name}, known)};
}

bool has_trait(std::string_view kind, Trait trait) { return (term_kind(kind).traits & trait) != 0; }

bool may_act_on_one_axis(const TermKind& kind) {
  return (kind.traits & kPerAxis) != 0 || kind.stage == Stage::Restoring;
}

const Parameter& parameter_of(const TermKind& kind, std::string_view name) {
  for (const auto& parameter : kind.parameters)
    if (parameter.name == name) return parameter;
  throw Error{"term '" + std::string{kind.name} + "' has no parameter '" + std::string{name} + "'"};
}

}  // namespace rths::sim

// SPDX-License-Identifier: Apache-2.0

#include <rths/sim/loop_test.hpp>

namespace rths::sim {
namespace {

TermSettings typical(const TermKind& kind) {
  TermSettings settings;
  settings.kind = kind.name;
  for (const auto& parameter : kind.parameters)
    settings.parameters.emplace_back(parameter.name, parameter.typical);
  return settings;
}

// Other terms that the demonstration of a kind needs.
std::vector<TermSettings> companions_of(const TermKind& kind) {
  std::vector<TermSettings> companions;
  const auto add = [&](std::string_view name) {
    if (name != kind.name) companions.push_back(typical(term_kind(name)));
  };
  if (kind.stage == Stage::Restoring) return companions;
  if (kind.stage == Stage::Vertical && kind.name != "elastomeric_axial") add("elastomeric_axial");
  // The first computes the critical load; the second uses it.
  if (kind.name == "buckling_load_variation") add("horizontal_stiffness_variation");
  if (kind.name == "horizontal_stiffness_variation") add("buckling_load_variation");
  if (kind.name != "elastomeric_axial") add("bouc_wen");
  return companions;
}

}  // namespace

Demonstration demonstrate(const TermKind& kind) {
  LoopTest test;
  test.amplitude_lat = 0.08;
  test.cycles = 3;
  test.axial_load_variation = 0.4;
  test.vertical_offset = -2e-3;
  test.vertical_amplitude = 4e-3;
  test.auxiliary = 0.5;
  test.time_step = 2e-3;
  Bearing bearing{std::string{kind.title}, companions_of(kind), 9.7e6};
  Demonstration demonstration;
  demonstration.alone = bearing.terms.empty();
  demonstration.without = run_loop_test(bearing, test);
  bearing.terms.push_back(typical(kind));
  demonstration.with = run_loop_test(bearing, test);
  return demonstration;
}

}  // namespace rths::sim

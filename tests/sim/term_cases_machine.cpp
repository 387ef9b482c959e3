// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {

// The range of a table is its maker's choice: it cannot be told from the values at the knots. The
// middle value is a hundredth of the outer ones, so the noise is small beside it.
std::vector<TermCase> machine_cases() {
  std::vector<TermCase> cases;
  for (const char* kind : {"tabulated_stiffness", "tabulated_damping", "tabulated_viscosity"})
    cases.push_back({kind, {}, {}, {"range"}, {}, 0.003});
  // Its force and its reference velocity are one parameter.
  cases.push_back({"power_damping", {}, {}, {"reference_velocity"}, {}});
  // The motion takes several steps to cross the presliding.
  for (const char* kind : {"planar_friction", "velocity_dependent_friction"})
    cases.push_back({kind, {"", "", {{"presliding", 5e-3}}}, {}, {}, {}});
  cases.push_back({"tabulated_friction", {}, {}, {"range", "creep_velocity"}, {}, 0.003});
  return cases;
}

}  // namespace rths::sim::test_support

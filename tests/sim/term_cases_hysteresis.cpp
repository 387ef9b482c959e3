// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {

std::vector<TermCase> hysteresis_cases() {
  // The reach defines the spline's knots; it is chosen, not fitted.
  TermCase iwan;
  iwan.kind = "iwan";
  iwan.fixed = {"reach"};
  std::vector<TermCase> cases{iwan};
  // Only a device shows what its input is.
  for (const char* kind : {"control_lag", "control_delay"}) {
    TermCase c;
    c.kind = kind;
    c.companions = {{"current_dependent_damping",
                     "",
                     {{"coefficient", 2e4}, {"coefficient_per_current", 4e4}}}};
    cases.push_back(c);
  }
  return cases;
}

}  // namespace rths::sim::test_support

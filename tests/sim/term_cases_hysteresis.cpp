// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {

std::vector<TermCase> hysteresis_cases() {
  // The reach defines the spline's knots; it is chosen, not fitted.
  TermCase iwan;
  iwan.kind = "iwan";
  iwan.fixed = {"reach"};
  return {iwan};
}

}  // namespace rths::sim::test_support

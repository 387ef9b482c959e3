// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test {

std::vector<TermCase> hysteresis_cases() {
  // The reach says where the knots of the spline are: it is chosen, like any grid.
  TermCase iwan;
  iwan.kind = "iwan";
  iwan.fixed = {"reach"};
  return {iwan};
}

}  // namespace rths::sim::test

// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {

namespace {

// Fast enough to reach the limit.
TermCase limited_loop() {
  TermCase c;
  c.kind = "actuator_bandwidth";
  c.term.parameters = {{"velocity_limit", 0.4}};
  c.motion.time_step = 2e-3;
  c.motion.steps = 2000;
  return c;
}

}  // namespace

std::vector<TermCase> actuator_cases() { return {limited_loop()}; }

}  // namespace rths::sim::test_support

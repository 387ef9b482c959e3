// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test {

std::vector<TermCase> actuator_cases() { return {}; }

}  // namespace rths::sim::test

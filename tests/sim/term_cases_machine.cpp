// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {

std::vector<TermCase> machine_cases() { return {}; }

}  // namespace rths::sim::test_support

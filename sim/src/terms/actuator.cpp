// SPDX-License-Identifier: Apache-2.0
#include "joined.hpp"
#include "kinds.hpp"

#include "actuator_kinds.hpp"

namespace rths::sim {

std::span<const TermKind> actuator_kinds() {
  static const auto kinds = joined({linear_actuator_kinds(), actuator_limit_kinds()});
  return kinds;
}

}  // namespace rths::sim

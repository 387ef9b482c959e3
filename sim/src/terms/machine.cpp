// SPDX-License-Identifier: Apache-2.0
#include "joined.hpp"
#include "kinds.hpp"

#include "machine_kinds.hpp"

namespace rths::sim {

std::span<const TermKind> machine_kinds() {
  static const auto kinds =
      joined({mount_kinds(), spring_kinds(), table_kinds(), friction_kinds(), drag_kinds()});
  return kinds;
}

}  // namespace rths::sim

// SPDX-License-Identifier: Apache-2.0
#include "elastomeric.hpp"

#include <vector>

#include "kinds.hpp"

namespace rths::sim {

std::span<const TermKind> elastomeric_kinds() {
  static const std::vector<TermKind> kinds = [] {
    std::vector<TermKind> all;
    for (const auto& group : {elastomeric_vertical_kinds(), elastomeric_modifier_kinds(),
                              lead_heating_kinds(), elastomeric_restoring_kinds()})
      all.insert(all.end(), group.begin(), group.end());
    return all;
  }();
  return kinds;
}

}  // namespace rths::sim

// SPDX-License-Identifier: Apache-2.0
#include "elastomeric.hpp"

#include "joined.hpp"
#include "kinds.hpp"

namespace rths::sim {

std::span<const TermKind> elastomeric_kinds() {
  static const auto kinds = joined({elastomeric_vertical_kinds(), elastomeric_modifier_kinds(),
                                    lead_heating_kinds(), elastomeric_restoring_kinds()});
  return kinds;
}

}  // namespace rths::sim

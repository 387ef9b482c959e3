// SPDX-License-Identifier: Apache-2.0
#include "joined.hpp"
#include "kinds.hpp"

#include "hysteresis_kinds.hpp"

namespace rths::sim {

std::span<const TermKind> hysteresis_kinds() {
  static const auto kinds = joined({bouc_wen_kinds(), plastic_kinds(), iwan_kinds(),
                                    model_form_kinds(), asymmetric_kinds(), controlled_kinds()});
  return kinds;
}

}  // namespace rths::sim

// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"

namespace rths::sim {

std::span<const TermKind> elastomeric_kinds() { return {}; }

}  // namespace rths::sim

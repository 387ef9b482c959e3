// SPDX-License-Identifier: Apache-2.0
#include "opensees_rows.hpp"

namespace rths::sim::test {

std::vector<OpenseesRow> sliding_rows() { return {}; }

}  // namespace rths::sim::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shaking.hpp"

namespace rths::bench {

/// A bearing that is measured.
struct Specimen {
  std::string name;  ///< of its file in the folder of compositions, less ".toml"
  std::string title;
  Demand demand;
  bool vertical = false;  ///< axial load from vertical displacement; else it is given
  double goal = 0;        ///< on the median of a step [ns]; 0: none
  std::string opensees;   ///< the same bearing there, as JSON
};

[[nodiscard]] std::vector<Specimen> all_specimens();

}  // namespace rths::bench

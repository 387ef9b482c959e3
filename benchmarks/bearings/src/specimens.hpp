// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shaking.hpp"

namespace rths::bench {

/// A bearing of the benchmark.
struct Specimen {
  std::string name;  ///< of its file in the folder of compositions, without ".toml"
  std::string title;
  Demand demand;
  bool vertical = false;  ///< true: axial load from vertical displacement; false: load given
  double goal = 0;        ///< for the median of a step [ns]; 0: none
  std::string opensees;   ///< the same bearing in OpenSees, as JSON
};

[[nodiscard]] std::vector<Specimen> all_specimens();

}  // namespace rths::bench

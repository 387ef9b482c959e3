// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/bench/step_times.hpp>

namespace rths::bench {

/// What a step of the same bearing takes in OpenSees.
struct OpenseesTimes {
  std::string element;
  double alone = 0;    ///< a step of an analysis with one element [ns]
  double further = 0;  ///< what each further element adds to it [ns]
  std::string version;
  std::string missing;  ///< why there is nothing above
};

/// Where OpenSees is.
struct OpenseesPlace {
  std::string python;            ///< that has it; empty: none
  std::filesystem::path script;  ///< that moves its elements
};

/// Runs an element along a motion, alone and many times over.
/// @param description  JSON: the element, its friction models and materials
[[nodiscard]] OpenseesTimes opensees_times(const OpenseesPlace& place,
                                           const std::string& description, const Shaking& shaking,
                                           double time_step);

}  // namespace rths::bench

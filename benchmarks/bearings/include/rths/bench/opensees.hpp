// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/bench/step_times.hpp>

namespace rths::bench {

/// Time of a step of the same bearing in OpenSees.
struct OpenSeesTimes {
  std::string element;
  double alone = 0;    ///< a step of an analysis with one element [ns]
  double further = 0;  ///< extra time of each further element [ns]
  std::string version;
  std::string missing;  ///< reason if it was not measured
};

/// Files that running OpenSees needs.
struct OpenSeesInstallation {
  std::string python;            ///< a Python with OpenSees; empty: none
  std::filesystem::path script;  ///< bearing.py
};

/// Times an analysis along a motion, with one element and with many.
/// @param description  JSON: the element, its friction models and materials
[[nodiscard]] OpenSeesTimes opensees_times(const OpenSeesInstallation& opensees,
                                           const std::string& description, const Shaking& shaking,
                                           double time_step);

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

namespace rths::commissioning {

/// Signals of a recording at equal intervals.
struct Recorded {
  double interval = 0;                      ///< [s]
  double begin = 0;                         ///< time of the first sample [s]
  std::vector<std::vector<double>> values;  ///< one column per name [SI]
};

/// Signals at the recording's usual interval. Missing rows are interpolated linearly.
/// @throws Error if a signal, all its values or all rows are missing   @setup
[[nodiscard]] Recorded recorded(const recording::Reader& run,
                                const std::vector<std::string>& names);

/// Signal of an axis by its role of [roles.<axis>]: "command", "machine_displacement".
/// @throws Error for an unknown role   @setup
[[nodiscard]] const std::string& signal_of(const recording::AxisRoles& axis,
                                           const std::string& role);
/// True if the name is a role of an axis.   @setup
[[nodiscard]] bool is_axis_role(const std::string& name);

}  // namespace rths::commissioning

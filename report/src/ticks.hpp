// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

#include "analysis.hpp"

namespace rths::report {

/// Series of signals: one value per tick of the controller. Without a controller of this project,
/// one value per row, up to the end of the test.
class Ticks {
 public:
  /// @throws Error if the recording contains no steps of its controller
  Ticks(const Reader& run, const Roles& roles);
  [[nodiscard]] Series series(const std::string& signal) const;
  [[nodiscard]] double interval() const { return interval_; }

 private:
  [[nodiscard]] std::vector<double> first_rows(std::vector<double> values) const;

  const Reader& run_;
  std::optional<recording::NodeTicks> ticks_;
  std::size_t rows_ = 0;
  double interval_ = 0;
};

/// The vertical force of a test.
/// @param rate   wall time over model time
/// @param first  model time of the first target [s]
/// @returns nothing if the controller does not control the vertical force
[[nodiscard]] std::optional<VerticalAnalysis> analyse_vertical(const Reader& run,
                                                               const Ticks& ticks,
                                                               const Roles& roles, double rate,
                                                               double first);

}  // namespace rths::report

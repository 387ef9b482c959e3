// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "unit_scales.hpp"

namespace rths::diagnosis {

/// Size of a signal over all records.
struct SignalSize {
  double peak = 0, rms = 0, rate = 0;  ///< rate: largest rate of change [1/s]
  std::string unit = "m";
};

/// Motion and force of a connection in the simulation as stated.
struct ConnectionSize {
  double displacement = 0, velocity = 0;  ///< largest [m], [m/s]
  double acceleration = 0;                ///< if known [m/s²]
  double force = 0;         ///< of the linear spring and damper, or of the moving mass [N]
  bool has_spring = false;  ///< a linear one: play in series with it is possible
};

/// Natural units of a case, from its records.
struct DynamicSizes {
  std::vector<SignalSize> inputs, outputs;  ///< outputs: as measured
  std::vector<ConnectionSize> connections;
  double time_step = 0;  ///< [s]
  bool has_time = true;

  [[nodiscard]] double time_scale() const;
  /// Units of the terms on a signal, and on a connection.
  [[nodiscard]] UnitScales of_signal(const SignalSize& size) const;
  [[nodiscard]] UnitScales of_connection(const ConnectionSize& size) const;
};

/// Includes the signal of another record.
void enlarge(SignalSize& size, const std::vector<double>& signal, double time_step);

}  // namespace rths::diagnosis

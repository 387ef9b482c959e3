// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "unit_scales.hpp"

namespace rths::diagnosis {

/// How large a signal is over the records.
struct SignalSize {
  double peak = 0, rms = 0, rate = 0;  ///< rate: largest [1/s]
};

/// How far a connection moves in the simulation as it is stated, and what forces belong to that.
struct ConnectionSize {
  double displacement = 0, velocity = 0;  ///< largest [m], [m/s]
  double acceleration = 0;                ///< where it is known [m/s²]
  double force = 0;  ///< of the linear spring and damper, or of the inertia that it moves [N]
  bool has_spring = false;  ///< a linear one, which play can stand in series with
};

/// Natural units of a case, taken from its records.
struct DynamicSizes {
  std::vector<SignalSize> inputs, outputs;  ///< outputs: as measured
  std::vector<ConnectionSize> connections;
  double time_step = 0;  ///< [s]

  [[nodiscard]] double time_scale() const;
  /// In which terms on a signal compute.
  [[nodiscard]] UnitScales of_signal(const SignalSize& size) const;
  [[nodiscard]] UnitScales of_connection(const ConnectionSize& size) const;
};

/// Adds what another record holds.
void enlarge(SignalSize& size, const std::vector<double>& signal, double time_step);

}  // namespace rths::diagnosis

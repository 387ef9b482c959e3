// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/plant/large_plant_analysis.hpp>

namespace rths::plant::test {

/// Petrolia 1992, all three components.
/// @param scale  factor on the record
[[nodiscard]] sim::GroundMotion petrolia(double scale = 1);

inline constexpr double kTimeStep = 0.001;  ///< of most runs [s]

/// Response of a plant whose tested bearing is computed, too.
struct Response {
  double time_step = 0;
  MatrixXd tested;  ///< displacement of the tested bearing: long, lat; row by step [m]
  MatrixXd loads;   ///< vertical target of the tested bearing; row by step [N]
  MatrixXd floors;  ///< absolute acceleration of the floors; row by step [m/s²]
};
[[nodiscard]] Response drive(LargePlantAnalysis& plant, const sim::Bearing& tested,
                             double time_step, double duration);

/// Root mean square of the difference over that of the reference [%].
[[nodiscard]] double difference(const MatrixXd& found, const MatrixXd& reference);
/// Largest difference of the 5 % spectra of each floor from 0.3 to 33 Hz [%].
[[nodiscard]] double spectral_difference(const Response& found, const Response& reference);

}  // namespace rths::plant::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace rths::diagnosis {

/// Instants of a test: at rest first, so that what follows has a zero, then moving.
struct TestTime {
  double step = 0;      ///< [s]
  double rest = 0;      ///< at the beginning [s]
  double duration = 0;  ///< of all of it [s]

  [[nodiscard]] Eigen::Index samples() const;
  [[nodiscard]] double moving() const { return duration - rest; }  ///< [s]
  /// Time since the rest ended, by sample; 0 during it.
  [[nodiscard]] Eigen::VectorXd elapsed() const;
};

/// Motions that laboratories run. All begin at rest, at zero; amplitudes are those of the result.
///
/// Sine that grows over its first two periods. @param phase  [rad]
[[nodiscard]] Eigen::VectorXd sine(const TestTime& time, double amplitude, double frequency,
                                   double phase = 0);
/// Constant velocity to and fro. @param velocity  [amplitude/s]
[[nodiscard]] Eigen::VectorXd triangle(const TestTime& time, double amplitude, double velocity);
/// Sine whose amplitude rises in equal steps, up to the last.
[[nodiscard]] Eigen::VectorXd staircase(const TestTime& time, double amplitude, double frequency,
                                        int steps);
/// Sine whose frequency rises by the same factor in the same time.
[[nodiscard]] Eigen::VectorXd sweep(const TestTime& time, double amplitude, double from, double to);
/// To one side, hold, to the other, hold.
[[nodiscard]] Eigen::VectorXd ramps_and_holds(const TestTime& time, double amplitude,
                                              double velocity, double hold);
/// Bursts of a sine with rests between them.
[[nodiscard]] Eigen::VectorXd bursts(const TestTime& time, double amplitude, double frequency,
                                     int count);

}  // namespace rths::diagnosis

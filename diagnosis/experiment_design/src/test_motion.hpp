// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// Instants of a test: at rest first, which gives the zero level, then moving.
struct TestTime {
  double step = 0;      ///< [s]
  double rest = 0;      ///< at the beginning [s]
  double duration = 0;  ///< of the whole test [s]

  [[nodiscard]] Index samples() const;
  [[nodiscard]] double moving() const { return duration - rest; }  ///< [s]
  /// Time since the rest ended, by sample; 0 during it.
  [[nodiscard]] VectorXd elapsed() const;
};

/// Motions of tests. All begin at rest, at zero; amplitudes are those of the resulting motion.
///
/// Sine that grows over its first two periods. @param phase  [rad]
[[nodiscard]] VectorXd sine(const TestTime& time, double amplitude, double frequency,
                            double phase = 0);
/// Constant velocity in alternating directions. @param velocity  [amplitude/s]
[[nodiscard]] VectorXd triangle(const TestTime& time, double amplitude, double velocity);
/// Sine whose amplitude rises in equal steps, up to the last.
[[nodiscard]] VectorXd staircase(const TestTime& time, double amplitude, double frequency,
                                 int steps);
/// Sine whose frequency rises exponentially.
[[nodiscard]] VectorXd sweep(const TestTime& time, double amplitude, double from, double to);
/// Ramps from one side to the other, with a hold at each.
[[nodiscard]] VectorXd ramps_and_holds(const TestTime& time, double amplitude, double velocity,
                                       double hold);
/// Bursts of a sine with rests between them.
[[nodiscard]] VectorXd bursts(const TestTime& time, double amplitude, double frequency, int count);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <rths/verdict/diagnose.hpp>

namespace rths::diagnosis::test_support {

constexpr double kStep = 0.004, kLength = 40, kQuiet = 2;  // of a record [s]
constexpr double kShortLength = 16;                        // enough for large effects [s]
constexpr double kForceNoise = 20;                         // [N]

/// A specimen on one axis that moves by about 0.1 m. Returns the force of its load cell before
/// rounding [N], from time [s], displacement [m] and velocity [m/s].
using Specimen = std::function<double(double, double, double)>;

struct Recorded {
  double force_step = 0;    ///< resolution of the load cell; 0: none [N]
  double length = kLength;  ///< [s]
};

/// Two seconds at rest, then four sines at random frequencies, sampled at 250 Hz.
Record record_of(const std::string& name, Use use, unsigned seed, const Specimen& specimen,
                 const Recorded& recorded = {});

}  // namespace rths::diagnosis::test_support

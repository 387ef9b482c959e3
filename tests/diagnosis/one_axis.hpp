// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <rths/diagnosis/diagnose.hpp>

namespace rths::diagnosis::test {

constexpr double kStep = 0.004, kLength = 40, kQuiet = 2;  // of a record [s]
constexpr double kForceNoise = 20;                         // [N]

/// Something on one axis that is moved by 0.1 m or so: at a time [s] from its displacement [m] and
/// velocity [m/s] the force that its load cell reads before it is rounded [N].
using Specimen = std::function<double(double, double, double)>;

/// Two seconds at rest, then four sines of frequencies of their own by seed, at 250 Hz.
/// @param force_step  of the load cell's counts; 0: none [N]
Record record_of(const std::string& name, Use use, unsigned seed, const Specimen& specimen,
                 double force_step = 0);

}  // namespace rths::diagnosis::test

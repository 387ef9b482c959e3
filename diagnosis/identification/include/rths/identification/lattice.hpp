// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <rths/identification/record.hpp>

namespace rths::diagnosis {

/// A channel with quantisation steps coarse enough to matter.
struct Lattice {
  std::string role, unit;
  double step = 0;       ///< [unit]
  double deviation = 0;  ///< standard error of the step: samples are printed with few digits [unit]
  double on_steps = 0;   ///< fraction of the changes that are whole numbers of steps [-]
};

/// Channels whose samples repeat or jump by whole steps, with a step of at least 0.005 of the
/// channel's standard deviation.
[[nodiscard]] std::vector<Lattice> coarse_lattices(const std::vector<const Record*>& records);

/// Standard deviation of the rounding error of each such channel, by role. It adds to the noise.
[[nodiscard]] std::vector<std::pair<std::string, double>> rounding_of(
    const std::vector<Lattice>& lattices);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
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

}  // namespace rths::diagnosis

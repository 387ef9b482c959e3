// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "hybrid_test.hpp"
#include "spectrum.hpp"

namespace trial {

inline constexpr std::size_t kTimeCells = 100;     ///< of a record
inline constexpr std::size_t kStateCells = 9;      ///< along displacement and along velocity
inline constexpr double kStateDisplacement = 0.2;  ///< outer edge of the cells on both sides [m]
inline constexpr double kStateVelocity = 0.8;      ///< [m/s]

/// Edges of the third octaves; the first one begins at zero [Hz].
std::vector<double> third_octaves();

/// Smallest set of cells that holds 80 % of a signal's energy, in ascending order, and the share of
/// the energy in every cell.
struct PlacedEnergy {
  std::vector<std::size_t> cells;
  std::vector<double> share;
};

/// Energy of a signal over the cells of time, frequency and state. A cell of state is the
/// displacement cell times kStateCells plus the velocity cell.
struct Place {
  PlacedEnergy time, frequency, state;
};

/// @param signal  longitudinal axis, then lateral axis, at kCompareRate
Place place_of(const Signal& signal, const Record& record);

}  // namespace trial

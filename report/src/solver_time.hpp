// SPDX-License-Identifier: Apache-2.0
//
// The solver's own time, move by move: each move of the machine advances it by one integration
// step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conditions.hpp"

namespace rths::report {

/// A move of the machine, as recorded.
struct SolverMove {
  double at = 0;        ///< its first row, since the run began [s]
  std::size_t row = 0;  ///< in which its words are read
  double count = 0;     ///< of all moves until then
  double time = 0;      ///< of the solver [s]
};

/// The solver's time at each move.
struct SolverTime {
  std::string signal;             ///< of the time; empty: no solver has recorded its time
  std::string counter;            ///< the signal that counts its moves
  bool is_counted = false;        ///< solver or controller count the moves; else rows can miss some
  std::vector<SolverMove> moves;  ///< up to the end of the test
  double usual_move = 0;  ///< from move to move [s]; 0: too short for the rows to see each one
  std::size_t start = 0;  ///< the first move from rest; a static analysis may have moves before
};
[[nodiscard]] SolverTime solver_time_of(const Reader& run);

/// Model time that the test reached: of the last target, or else the targets times the step.
/// @param experiment  of the recording   @param is_completed  the run ended in order
[[nodiscard]] double reached_in(const Reader& run, const SolverTime& solver,
                                const Config& experiment, bool is_completed);

/// Each move advances the solver's time by one integration step.
/// @param step  in model time [s]
[[nodiscard]] Break time_of(const SolverTime& solver, double step);

/// The test takes the time that the experiment's rate states.
/// @param rate  wall time over model time, as planned   @param step  as in `achieved_rate`
[[nodiscard]] Break rate_of(const SolverTime& solver, double rate, double step);

/// The solver's targets are of a size that a specimen can reach, and do not stop abruptly.
[[nodiscard]] Break targets_limit_of(const Reader& run, const SolverTime& solver);
[[nodiscard]] Break targets_live_of(const Reader& run, const SolverTime& solver);

/// Wall time over model time of the test; none without moves that advance the time.
/// @param step  model time of a move, where the solver has recorded no time [s]
[[nodiscard]] std::optional<double> achieved_rate(const SolverTime& solver, double step);

}  // namespace rths::report

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <rths/bench/load.hpp>
#include <rths/bench/machine.hpp>
#include <rths/bench/rows.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

/// What one row gave in one cycle: a pairing, or why there is none.
struct Outcome {
  std::optional<Pairing> pairing;
  std::string missing;
};

/// One pass over all rows.
struct Cycle {
  std::map<std::string, Outcome> outcomes;  ///< by name of row
  Load load;                                ///< by others, meanwhile
};

enum class GateResult { Pass, Fail, Inconclusive, NotJudged, Missing };

[[nodiscard]] const char* to_text(GateResult verdict) noexcept;

/// A row over all cycles.
struct RowResult {
  Row row;
  Times times;              ///< medians over cycles
  double ratio_p50 = 0;     ///< measured / reference, median over cycles [-]
  Interval ratio_interval;  ///< 95 % of that median
  double ratio_p99 = 0;
  double value = 0;  ///< of the row's quantity, median over cycles
  Interval value_interval;
  int cycles = 0;      ///< that the medians are over
  bool noisy = false;  ///< too few of them were quiet, so all were taken
  GateResult verdict = GateResult::NotJudged;
  std::string missing;  ///< why there is nothing above
};

/// Paired raw times of a quiet machine lie in here; below, the two processors share a core [ns].
inline constexpr Interval kPlausibleRaw{90, 230};
/// A store that nobody reads takes a cycle or two; longer, and somebody else is on the core [ns].
inline constexpr double kLongestPlainStore = 0.6;
/// A cycle is quiet if others took no more than this of the two processors [-].
inline constexpr Load kQuiet{0.10, 0.02};
/// Fewer quiet cycles than these say nothing.
inline constexpr std::size_t kFewestCycles = 3;

[[nodiscard]] bool is_quiet(const Load& load);
/// Whether a value is as good as a quantity's bound asks.
[[nodiscard]] bool holds(Quantity quantity, double value, double bound);

/// @param cycles  as many as were measured, the order does not matter
/// @param seed    of the intervals
[[nodiscard]] RowResult judge_row(const Row& row, const std::vector<Cycle>& cycles,
                                  std::uint64_t seed);

/// The raw times that rows were paired with, over the whole run.
struct RawSpread {
  double median = 0, low = 0, high = 0;  ///< and quartiles [ns]
};
[[nodiscard]] RawSpread raw_spread(const std::vector<Row>& rows, const std::vector<Cycle>& cycles);

/// Why this machine, now, cannot tell whether a gate holds; empty if it can.
[[nodiscard]] std::vector<std::string> troubles(const Machine& machine,
                                                const std::vector<Cycle>& cycles,
                                                const std::vector<RowResult>& results,
                                                const RawSpread& raw);

/// Of the whole run: Pass, Fail or Inconclusive.
[[nodiscard]] GateResult overall(const std::vector<RowResult>& results,
                                 const std::vector<std::string>& troubles);

}  // namespace rths::bench

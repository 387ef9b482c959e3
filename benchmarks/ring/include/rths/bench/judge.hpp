// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <rths/bench/load.hpp>
#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>
#include <rths/bench/rows.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

/// Result of one row in one cycle: a pairing, or the reason why it is missing.
struct Outcome {
  std::optional<Pairing> pairing;
  std::string missing;
};

/// One pass over all rows.
struct Cycle {
  std::map<std::string, Outcome> outcomes;  ///< by name of row
  Load load;                                ///< by other processes during the cycle
};

/// Result of a row over all cycles.
struct RowResult {
  Row row;
  Times times;              ///< medians over cycles
  double ratio_p50 = 0;     ///< measured / reference, median over cycles [-]
  Interval ratio_interval;  ///< 95 % interval of that median
  double ratio_p99 = 0;
  double value = 0;  ///< of the row's quantity, median over cycles
  Interval value_interval;
  int cycles = 0;      ///< number of cycles in the medians
  bool noisy = false;  ///< too few cycles were quiet, so all were used
  GateResult gate_result = GateResult::NotJudged;
  std::string missing;  ///< reason if the row was not measured
};

/// Range of raw times on a quiet machine; below, the two processors share a core [ns].
inline constexpr Interval kPlausibleRaw{90, 230};
/// A store without readers takes a clock cycle or two; above, another process is on the core [ns].
inline constexpr double kLongestPlainStore = 0.6;
/// Least number of quiet cycles for a gate result.
inline constexpr std::size_t kFewestCycles = 3;

/// True if a value satisfies the bound of a quantity.
[[nodiscard]] bool holds(Quantity quantity, double value, double bound);

/// Judges a row.
/// @param cycles  all measured cycles, in any order
/// @param seed    of the intervals
[[nodiscard]] RowResult judge_row(const Row& row, const std::vector<Cycle>& cycles,
                                  std::uint64_t seed);

/// Raw times that the rows were paired with, over the whole run.
struct RawSpread {
  double median = 0, low = 0, high = 0;  ///< median and quartiles [ns]
};
[[nodiscard]] RawSpread raw_spread(const std::vector<Row>& rows, const std::vector<Cycle>& cycles);

/// Reasons why the run is inconclusive on this machine; empty if it is conclusive.
[[nodiscard]] std::vector<std::string> troubles(const Machine& machine,
                                                const std::vector<Cycle>& cycles,
                                                const std::vector<RowResult>& results,
                                                const RawSpread& raw);

/// Result of the whole run: Pass, Fail or Inconclusive.
[[nodiscard]] GateResult overall(const std::vector<RowResult>& results,
                                 const std::vector<std::string>& troubles);

}  // namespace rths::bench

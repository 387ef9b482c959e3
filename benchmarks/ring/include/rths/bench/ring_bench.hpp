// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/bench/judge.hpp>
#include <rths/bench/machine.hpp>
#include <rths/bench/rows.hpp>

namespace rths::bench {

struct RingOptions {
  int cycles = 9;
  std::uint32_t round_trips = 50'000;  ///< of each row in each cycle
  std::uint64_t seed = 1;              ///< of the intervals
  std::vector<std::string> rows;       ///< names; empty: all
  std::filesystem::path programs;      ///< folder of the peers' programs
  /// Folder for finished cycles; a later run reuses them. Empty: none.
  std::filesystem::path keep;
  std::function<void(const std::string& stage)> progress;  ///< called before each row
};

/// Result of a run.
struct RingReport {
  Machine machine;
  int cycles = 0;
  std::uint32_t round_trips = 0;
  std::uint64_t seed = 0;
  RawSpread raw;
  std::vector<RowResult> rows;
  std::vector<std::string> troubles;  ///< reasons why the result is inconclusive
  GateResult result = GateResult::Inconclusive;
};

/// Measures all rows one after the other, in several cycles, each row directly after its raw
/// reference. Every second cycle is in reverse order. At most two processes spin; this process is
/// one of them or sleeps.
/// @throws Error if a row is unknown or fails   @setup
[[nodiscard]] RingReport run_ring_bench(const RingOptions& options);

/// The report as one JSON document, or as tables of text.
[[nodiscard]] std::string to_json(const RingReport& report);
[[nodiscard]] std::string to_text(const RingReport& report);

}  // namespace rths::bench

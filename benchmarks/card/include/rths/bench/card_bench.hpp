// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>

namespace rths::bench {

struct CardOptions {
  int passes = 5;
  double seconds = 0.5;  ///< computing time of a pass [s]
};

/// A saturated ring of cards.
struct CardRow {
  std::string name, title;
  int nodes = 0, senders = 0;
  double hops_per_s = 0;       ///< of computing time, median over passes [1/s]
  double megabytes_per_s = 0;  ///< data of all senders in virtual time [MB/s]
  double published = 0;        ///< the same in the card's manual [MB/s]
  double goal = 0;             ///< for hops_per_s; 0: none
  GateResult gate_result = GateResult::NotJudged;
};

struct CardReport {
  Machine machine;
  int passes = 0;
  std::vector<CardRow> rows;
  GateResult result = GateResult::Inconclusive;
};

/// Measures rings of cards in virtual time on this thread.
[[nodiscard]] CardReport run_card_bench(const CardOptions& options);

/// The report as one JSON document, or as a table.
[[nodiscard]] std::string to_json(const CardReport& report);
[[nodiscard]] std::string to_text(const CardReport& report);

}  // namespace rths::bench

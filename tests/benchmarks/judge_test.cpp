// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/judge.hpp>

#include <gtest/gtest.h>

namespace rths::bench {
namespace {

constexpr double kRaw = 150;  // [ns], plausible

Row own_row() {
  return {"ours", 4, "a row of ours", nullptr, Quantity::RatioToRaw, Gate{1.05, 1.15}};
}

Row peer_row() {
  return {"theirs",
          4,
          "a peer",
          nullptr,
          Quantity::TimesOurs,
          Gate{8, 5},
          std::nullopt,
          Peer{"program", "ours"}};
}

Outcome paired(double ratio, double raw = kRaw, double tail_ratio = 1) {
  return {Pairing{{ratio * raw, tail_ratio * raw}, {raw, raw}}, ""};
}

Cycle cycle(double ours, double raw = kRaw, Load load = {}) {
  return {{{"ours", paired(ours, raw)}, {"theirs", paired(10 * ours, raw)}}, load};
}

Machine two_cores() {
  Machine machine;
  machine.chosen = Choice{{0, 1}, false};
  return machine;
}

/// Results of a run with these cycles.
struct Conclusion {
  std::vector<RowResult> results;
  std::vector<std::string> troubles;
  GateResult gate_result;
};

Conclusion conclude(const std::vector<Row>& rows, const std::vector<Cycle>& cycles,
                    const Machine& machine = two_cores()) {
  Conclusion conclusion;
  for (const Row& row : rows) conclusion.results.push_back(judge_row(row, cycles, 1));
  conclusion.troubles = troubles(machine, cycles, conclusion.results, raw_spread(rows, cycles));
  conclusion.gate_result = overall(conclusion.results, conclusion.troubles);
  return conclusion;
}

bool mentions(const Conclusion& conclusion, const std::string& words) {
  for (const auto& trouble : conclusion.troubles)
    if (trouble.find(words) != std::string::npos) return true;
  return false;
}

TEST(RowGateResult, IsPassUpToTheGateAndFailBeyond) {
  const auto with_median = [](double ratio) {
    return judge_row(own_row(), {cycle(1), cycle(ratio), cycle(2)}, 1);
  };

  EXPECT_EQ(with_median(1.15).gate_result, GateResult::Pass);
  EXPECT_EQ(with_median(1.16).gate_result, GateResult::Fail);
  EXPECT_DOUBLE_EQ(with_median(1.16).value, 1.16);
}

TEST(RowGateResult, HasALowerBoundForFactorsAndAnUpperBoundOtherwise) {
  EXPECT_TRUE(holds(Quantity::RatioToRaw, 1, 2));
  EXPECT_TRUE(holds(Quantity::RatioToOther, 1, 2));
  EXPECT_TRUE(holds(Quantity::Time, 1, 2));
  EXPECT_TRUE(holds(Quantity::ExtraTime, 1, 2));
  EXPECT_FALSE(holds(Quantity::TimesCheaper, 1, 2));
  EXPECT_FALSE(holds(Quantity::TimesOurs, 1, 2));
}

TEST(RowGateResult, LeavesOutPairingsWithASlowPlainStore) {
  Row row = own_row();
  row.quantity = Quantity::ExtraTime;
  row.gate = Gate{1, 2.5};
  std::vector<Cycle> cycles(6);
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const double store = i % 2 == 0 ? 0.5 : 1.5;
    cycles[i].outcomes["ours"] = {Pairing{{4 * store, 5}, {store, store}}, ""};
  }

  const RowResult result = judge_row(row, cycles, 1);

  EXPECT_DOUBLE_EQ(result.value, 1.5);
  EXPECT_EQ(result.cycles, 3);
  EXPECT_EQ(result.gate_result, GateResult::Pass);
}

TEST(RowGateResult, LeavesOutPairingsWhoseProcessorsShareACore) {
  Row row = own_row();
  row.quantity = Quantity::TimesCheaper;
  row.gate = Gate{15, 8};
  std::vector<Cycle> cycles(6);
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const bool shared = i % 2 == 0;
    cycles[i].outcomes["ours"] = {
        Pairing{{10, 12}, {shared ? 10.0 : 160.0, 170}, shared ? 30.0 : kRaw}, ""};
  }

  const RowResult result = judge_row(row, cycles, 1);

  EXPECT_DOUBLE_EQ(result.value, 16);
  EXPECT_EQ(result.cycles, 3);
}

TEST(RowGateResult, IsFailIfOnlyTheTailFails) {
  Row row = own_row();
  row.tail_gate = Gate{1.25, 1.6};
  std::vector<Cycle> cycles(3);
  for (Cycle& each : cycles) each.outcomes["ours"] = paired(1, kRaw, 1.7);

  EXPECT_EQ(judge_row(row, cycles, 1).gate_result, GateResult::Fail);
}

TEST(RowGateResult, ComparesAPeerWithOurRowOfTheSameCycle) {
  const RowResult result = judge_row(peer_row(), {cycle(1), cycle(1.1), cycle(1.2)}, 1);

  EXPECT_DOUBLE_EQ(result.value, 10);
  EXPECT_DOUBLE_EQ(result.ratio_p50, 11);
  EXPECT_EQ(result.gate_result, GateResult::Pass);
}

TEST(RowGateResult, IsNotJudgedWithoutAGate) {
  Row row = own_row();
  row.gate.reset();

  EXPECT_EQ(judge_row(row, {cycle(9), cycle(9), cycle(9)}, 1).gate_result, GateResult::NotJudged);
}

TEST(RowGateResult, IsMissingWithTheReasonIfNothingWasMeasured) {
  const Cycle empty{{{"ours", {std::nullopt, "is not built"}}}, {}};

  const RowResult result = judge_row(own_row(), {empty, empty, empty}, 1);

  EXPECT_EQ(result.gate_result, GateResult::Missing);
  EXPECT_EQ(result.missing, "is not built");
}

TEST(RowGateResult, LeavesOutCyclesThatWereNotQuiet) {
  const Load busy{0.3, 0};

  const RowResult result =
      judge_row(own_row(), {cycle(1), cycle(1), cycle(1), cycle(9, kRaw, busy), cycle(9, 29)}, 1);

  EXPECT_EQ(result.cycles, 3);
  EXPECT_EQ(result.gate_result, GateResult::Pass);
  EXPECT_FALSE(result.noisy);
}

TEST(RowGateResult, IsInconclusiveWithoutThreeQuietCycles) {
  const Load stolen{0, 0.05};

  const RowResult result = judge_row(own_row(), {cycle(9), cycle(9), cycle(9, kRaw, stolen)}, 1);

  EXPECT_EQ(result.cycles, 3);
  EXPECT_TRUE(result.noisy);
  EXPECT_EQ(result.gate_result, GateResult::Inconclusive);
}

TEST(RunGateResult, IsPassIfEveryGateHolds) {
  const auto conclusion = conclude({own_row(), peer_row()}, {cycle(1), cycle(1), cycle(1)});

  EXPECT_EQ(conclusion.gate_result, GateResult::Pass);
  EXPECT_TRUE(conclusion.troubles.empty());
}

TEST(RunGateResult, IsFailIfOneGateFails) {
  EXPECT_EQ(conclude({own_row(), peer_row()}, {cycle(2), cycle(2), cycle(2)}).gate_result,
            GateResult::Fail);
}

TEST(RunGateResult, IsInconclusiveOnSiblingsOfOneCore) {
  Machine machine;
  machine.chosen = Choice{{0, 1}, true};

  const auto conclusion = conclude({own_row()}, {cycle(2), cycle(2), cycle(2)}, machine);

  EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
  EXPECT_TRUE(mentions(conclusion, "share a core"));
}

TEST(RunGateResult, IsInconclusiveOnASingleProcessor) {
  const auto conclusion = conclude({own_row()}, {}, Machine{});

  EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
  EXPECT_TRUE(mentions(conclusion, "only one processor"));
}

TEST(RunGateResult, IsInconclusiveOnABusyMachine) {
  const Cycle busy = cycle(2, kRaw, Load{0.5, 0.0});

  const auto conclusion = conclude({own_row()}, {busy, busy, busy, cycle(1)});

  EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
  EXPECT_TRUE(mentions(conclusion, "busy"));
}

TEST(RunGateResult, IsInconclusiveIfRawIsImplausible) {
  for (const double raw : {29.0, 400.0}) {
    const auto conclusion = conclude({own_row()}, {cycle(1, raw), cycle(1, raw), cycle(1, raw)});

    EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
    EXPECT_TRUE(mentions(conclusion, "raw takes")) << raw;
  }
}

TEST(RunGateResult, IsInconclusiveIfRawIsUnstable) {
  const auto conclusion = conclude(
      {own_row()}, {cycle(1, 100), cycle(1, 100), cycle(1, 150), cycle(1, 200), cycle(1, 200)});

  EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
  EXPECT_TRUE(mentions(conclusion, "unstable"));
}

TEST(RunGateResult, IsInconclusiveIfAJudgedPeerIsMissing) {
  Cycle without = cycle(1);
  without.outcomes["theirs"] = {std::nullopt, "rths_peer_theirs is not built"};

  const auto conclusion = conclude({own_row(), peer_row()}, {without, without, without});

  EXPECT_EQ(conclusion.gate_result, GateResult::Inconclusive);
  EXPECT_TRUE(mentions(conclusion, "rths_peer_theirs is not built"));
}

TEST(RunGateResult, IsInconclusiveAfterTooFewCycles) {
  EXPECT_EQ(conclude({own_row()}, {cycle(1), cycle(1)}).gate_result, GateResult::Inconclusive);
}

}  // namespace
}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#include "acceptance.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include <rths/identification/constants.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

constexpr std::uint64_t kAcceptanceSeed = 5;
constexpr Threshold kLeast{18, kLeastGainOfAnEvent};

ScoredCandidate gaining(const std::string& name, const std::vector<double>& blocks) {
  ScoredCandidate scored{friction(name), {}, 0, blocks, 0, 0, 0.25};
  scored.gain = std::accumulate(blocks.begin(), blocks.end(), 0.0);
  return scored;
}
std::vector<double> even(double gain, std::size_t blocks = 50) {
  return std::vector<double>(blocks, gain / static_cast<double>(blocks));
}
std::vector<std::string> names_of(const std::vector<ScoredCandidate>& ranked) {
  std::vector<std::string> names;
  for (const auto& one : ranked) names.push_back(one.candidate.name);
  return names;
}
using Strings = std::vector<std::string>;

TEST(Acceptance, NeedsMoreThanTheLeastGain) {
  EXPECT_TRUE(is_acceptable(gaining("x", even(20.1)), {20, 90}, kAcceptanceSeed));
  EXPECT_FALSE(is_acceptable(gaining("x", even(20)), {20, 90}, kAcceptanceSeed));
}

// One block in fifty is absent from a resampled record with the probability (1 − 1/50)⁵⁰ = 36 %.
TEST(Acceptance, NeedsAGainInNearlyAllResampledRecords) {
  std::vector<double> blocks(50, -0.5);
  blocks[7] = 60;

  EXPECT_FALSE(is_acceptable(gaining("x", blocks), kLeast, kAcceptanceSeed));
}

// A rare event that costs nothing elsewhere.
TEST(Acceptance, AcceptsALargeGainAtOneInstant) {
  std::vector<double> blocks(50, 0.0);
  blocks[7] = kLeastGainOfAnEvent + 1;
  EXPECT_TRUE(is_acceptable(gaining("x", blocks), kLeast, kAcceptanceSeed));

  blocks[7] = kLeastGainOfAnEvent - 1;
  EXPECT_FALSE(is_acceptable(gaining("x", blocks), kLeast, kAcceptanceSeed));
}

// Without the instant, 50 blocks cost 5 or 10 nat, 2 or 4 % of the gain. Scatter explains 18.
TEST(Acceptance, AcceptsAnInstantThatCostsAFewPercentElsewhere) {
  for (const auto& [cost, is_accepted] : {std::pair{0.1, true}, {0.2, false}}) {
    std::vector<double> blocks(50, -cost);
    blocks[7] = 3 * kLeastGainOfAnEvent;
    EXPECT_EQ(is_acceptable(gaining("x", blocks), kLeast, kAcceptanceSeed), is_accepted) << cost;
  }
}

TEST(HeldBack, WaitsForAnAcceptableSimplerCandidate) {
  ScoredCandidate complex = gaining("complex", even(100));
  complex.candidate.after = {"simple"};
  std::vector<ScoredCandidate> ranked{complex, gaining("simple", even(90))};

  EXPECT_EQ(names_of(held_back(ranked, nullptr, kLeast, kAcceptanceSeed)), Strings{"complex"});
  EXPECT_EQ(names_of(ranked), Strings{"simple"});
}

TEST(HeldBack, DoesNotWaitForACandidateThatGainsTooLittle) {
  ScoredCandidate complex = gaining("complex", even(100));
  complex.candidate.after = {"simple"};
  std::vector<ScoredCandidate> ranked{complex, gaining("simple", even(10))};

  EXPECT_TRUE(held_back(ranked, nullptr, kLeast, kAcceptanceSeed).empty());
  EXPECT_EQ(names_of(ranked), (Strings{"complex", "simple"}));
}

TEST(HeldBack, LetsAHolderDefendItsPlace) {
  ScoredCandidate complex = gaining("complex", even(100));
  complex.candidate.after = {"simple"};
  std::vector<ScoredCandidate> ranked{complex, gaining("simple", even(90))};

  EXPECT_TRUE(held_back(ranked, &complex.candidate, kLeast, kAcceptanceSeed).empty());
}

TEST(Chosen, IsTheBestIfItLeadsSignificantly) {
  const auto round =
      chosen({gaining("best", even(100)), gaining("other", even(50))}, 0, kAcceptanceSeed);

  EXPECT_EQ(round.chosen.candidate.name, "best");
  EXPECT_TRUE(round.tied.empty());
  EXPECT_EQ(names_of(round.others), Strings{"other"});
}

// A lead that changes its sign from block to block is not significant.
TEST(Chosen, IsTheCheapestOfATie) {
  std::vector<double> blocks = even(100);
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] += i % 2 == 0 ? 10 : -10.1;
  ScoredCandidate costly = gaining("costly", even(100)), cheap = gaining("cheap", blocks);
  costly.candidate.price = 3;
  cheap.candidate.price = 1;

  const auto round = chosen({costly, cheap}, 0, kAcceptanceSeed);

  EXPECT_EQ(round.chosen.candidate.name, "cheap");
  EXPECT_EQ(names_of(round.tied), Strings{"costly"});
}

// 1 % of the gain is a tie, however significant.
TEST(Chosen, TiesWhatDiffersByLessThanOnePercent) {
  const auto round =
      chosen({gaining("best", even(1000)), gaining("next", even(991))}, 0, kAcceptanceSeed);

  EXPECT_EQ(names_of(round.tied), Strings{"next"});
}

// What a law contains besides the chosen one does not show, so it supports it.
TEST(Chosen, TakesNoLawThatContainsItForAnAlternative) {
  ScoredCandidate larger = gaining("larger", even(100)), simple = gaining("simple", even(100));
  larger.candidate.contains = {"simple"};
  larger.candidate.price = 2;
  simple.candidate.price = 1;

  const auto round = chosen({larger, simple}, 0, kAcceptanceSeed);

  EXPECT_EQ(round.chosen.candidate.name, "simple");
  EXPECT_DOUBLE_EQ(round.chosen.confidence, 0.5);
  EXPECT_TRUE(round.tied.empty());
}

// One effect on all axes and on one of them is one effect.
TEST(Chosen, CountsAnEffectOnSeveralAxesOnce) {
  ScoredCandidate both = gaining("x", even(100)), one = gaining("x", even(100));
  both.candidate.price = 1;
  one.candidate.price = 2;
  one.candidate.axis = "long";

  const auto round = chosen({both, one}, 0, kAcceptanceSeed);

  EXPECT_EQ(round.chosen.candidate.axis, "");
  EXPECT_DOUBLE_EQ(round.chosen.confidence, 0.5);
  EXPECT_TRUE(round.tied.empty());
  EXPECT_TRUE(round.others.empty());
}

// Where even the best leaves much, a rival that leaves 7 % more is not excluded, but costs more
// gain than a tie in which the cheaper one wins.
TEST(Chosen, TiesRivalsThatLeaveLittleMore) {
  ScoredCandidate cheap = gaining("cheap", even(930));
  cheap.candidate.price = 0;
  const std::vector<ScoredCandidate> ranked{gaining("best", even(1000)), cheap,
                                            gaining("far", even(850))};

  EXPECT_TRUE(chosen(ranked, 0, kAcceptanceSeed).tied.empty());
  const auto round = chosen(ranked, 1000, kAcceptanceSeed);
  EXPECT_EQ(round.chosen.candidate.name, "best");
  EXPECT_EQ(names_of(round.tied), Strings{"cheap"});
}

}  // namespace
}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/folds.hpp>

#include <bit>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

constexpr Eigen::Index kFoldRows = 320;
constexpr double kFoldStep = 0.025;  // 0.125 s are 5 rows, fewer than the least
constexpr Eigen::Index kPieceRows = 8;

std::vector<Record> records_for(const std::vector<Use>& uses) {
  std::vector<Record> records;
  for (const Use use : uses)
    records.push_back(linear_record("record " + std::to_string(records.size()), use, kFoldStep,
                                    sine_of(3, kFoldRows), {}));
  return records;
}

std::vector<std::string> names_of(const std::vector<const Record*>& records) {
  std::vector<std::string> names;
  for (const Record* record : records) names.push_back(record->name);
  return names;
}

using Names = std::vector<std::string>;

TEST(SplitOf, ScoresTheFirstOfTwoHeldOutRecords) {
  const auto records = records_for({Use::HeldOut, Use::Fit, Use::Reference, Use::HeldOut});

  const Split split = split_of(records);

  EXPECT_TRUE(split.by_record);
  EXPECT_EQ(names_of(split.records), (Names{"record 1", "record 0"}));
  EXPECT_EQ(names_of(split.held), (Names{"record 3"}));
}

TEST(SplitOf, HoldsOutAllIfManyRecordsFit) {
  const auto records =
      records_for({Use::Fit, Use::Fit, Use::Fit, Use::Fit, Use::HeldOut, Use::HeldOut});

  const Split split = split_of(records);

  EXPECT_FALSE(split.by_record);
  EXPECT_EQ(split.records.size(), 4U);
  EXPECT_EQ(names_of(split.held), (Names{"record 4", "record 5"}));
}

TEST(SplitOf, HoldsOutOneOrThreeRecords) {
  for (const std::size_t count : {1U, 3U}) {
    std::vector<Use> uses(count, Use::HeldOut);
    uses.push_back(Use::Fit);
    const auto records = records_for(uses);

    const Split split = split_of(records);

    EXPECT_FALSE(split.by_record);
    EXPECT_EQ(split.records.size(), 1U);
    EXPECT_EQ(split.held.size(), count);
  }
}

struct Divided {
  explicit Divided(std::vector<Record> all) : records{std::move(all)} {}
  LinearRelation relation;
  std::vector<Record> records;
  Split split = split_of(records);
  Problem problem{relation, split.records, SensorNoise{split.records, {}}, 1};
  Folds folds = folds_of(split, problem);
};

std::vector<std::size_t> records_in(const Fold& fold) {
  std::vector<std::size_t> records;
  for (const auto& share : fold.shares) records.push_back(share.record);
  return records;
}

TEST(FoldsOf, AreWholeRecordsOfASplitByRecord) {
  const Divided divided{records_for({Use::Fit, Use::Fit, Use::HeldOut, Use::HeldOut})};

  EXPECT_EQ(records_in(divided.folds.first), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(records_in(divided.folds.second), (std::vector<std::size_t>{2}));
  EXPECT_EQ(observations(divided.problem, divided.folds.both), 3.0 * kFoldRows);
}

TEST(FoldsOf, AlternateBetweenManyRecords) {
  const Divided divided{records_for(std::vector<Use>(5, Use::Fit))};

  EXPECT_EQ(records_in(divided.folds.first), (std::vector<std::size_t>{0, 2, 4}));
  EXPECT_EQ(records_in(divided.folds.second), (std::vector<std::size_t>{1, 3}));
}

TEST(FoldsOf, HaveEveryRowOfAFewRecordsOnce) {
  const Divided divided{records_for({Use::Fit, Use::Fit})};

  for (std::size_t i = 0; i < 2; ++i) {
    const auto& first = divided.folds.first.shares[i].weight;
    const auto& second = divided.folds.second.shares[i].weight;
    EXPECT_TRUE((first + second == 1).all());
    EXPECT_TRUE((first * second == 0).all());
    EXPECT_EQ(first.sum(), kFoldRows / 2);
  }
}

TEST(FoldsOf, BothContainPartOfAShortPeak) {
  const Divided divided{records_for({Use::Fit})};

  const auto& first = divided.folds.first.shares[0].weight;
  constexpr Eigen::Index kStrong = 3 * kPieceRows;
  for (Eigen::Index row = 0; row + kStrong <= kFoldRows; ++row) {
    EXPECT_GT(first.segment(row, kStrong).sum(), 0) << row;
    EXPECT_LT(first.segment(row, kStrong).sum(), kStrong) << row;
  }
}

TEST(FoldsOf, BothContainEachPartOfAMotionOfTenPeriods) {
  const Divided divided{records_for({Use::Fit})};

  const auto& first = divided.folds.first.shares[0].weight;
  for (Eigen::Index period = 1; period <= kFoldRows / 10; ++period)
    for (Eigen::Index phase = 0; phase < period; ++phase) {
      double sum = 0, all = 0;
      for (Eigen::Index row = phase; row < kFoldRows; row += period) sum += first[row], ++all;
      EXPECT_GT(sum, 0) << period << " " << phase;
      EXPECT_LT(sum, all) << period << " " << phase;
    }
}

// The rate that a case gives to rows of a quasi-static test is of no account.
TEST(FoldsOf, AreTheSameAtEveryRateOfCoarseRows) {
  std::vector<Eigen::ArrayXd> weights;
  for (const double rate : {1.0, 8.0, 64.0}) {
    const std::vector<Record> records{
        linear_record("record", Use::Fit, 1 / rate, sine_of(3, kFoldRows), {})};
    weights.push_back(Divided{records}.folds.first.shares[0].weight);
  }

  EXPECT_TRUE((weights[0] == weights[1]).all());
  EXPECT_TRUE((weights[0] == weights[2]).all());
}

// Records of one pressure each: the third pressure alone determines no law of the pressure.
std::vector<Record> records_at(const std::vector<double>& pressures) {
  std::vector<Record> records;
  for (const double pressure : pressures) {
    const Use use = records.size() < 2 ? Use::Fit : Use::HeldOut;
    records.push_back(linear_record("record " + std::to_string(records.size()), use, kFoldStep,
                                    sine_of(3, kFoldRows), {}));
    records.back().channels.push_back(
        {"auxiliary.pressure", "Pa", std::vector<double>(kFoldRows, pressure)});
  }
  return records;
}

TEST(FoldsOf, ArePiecesOfAllRecordsIfOneFoldWouldNotDetermineALaw) {
  const Divided divided{records_at({1e5, 7e5, 3e5, 5e5})};

  EXPECT_EQ(divided.split.undetermined, "auxiliary.pressure");
  EXPECT_FALSE(divided.split.by_record);
  EXPECT_EQ(names_of(divided.split.held), (Names{"record 3"}));
  EXPECT_EQ(records_in(divided.folds.first), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(records_in(divided.folds.second), (std::vector<std::size_t>{0, 1, 2}));
}

TEST(FoldsOf, AreWholeRecordsIfAStateIsTheSameInAll) {
  const Divided divided{records_at({1e5, 1e5, 1e5, 1e5})};

  EXPECT_EQ(divided.split.undetermined, "");
  EXPECT_TRUE(divided.split.by_record);
}

// A load that follows the order of Thue and Morse from piece to piece would be in one half alone.
TEST(FoldsOf, DivideEveryLevelOfAState) {
  std::vector<double> u(kFoldRows);
  for (Eigen::Index row = 0; row < kFoldRows; ++row)
    u[static_cast<std::size_t>(row)] =
        std::popcount(static_cast<std::uint64_t>(row / kPieceRows)) % 2 == 1 ? 1 : 0.1;
  std::vector<Record> records = records_for({Use::Fit});
  records[0].channels.push_back({"auxiliary.displacement", "m", u});
  records[0].channels.push_back({"auxiliary.velocity", "m/s", u});
  const Divided divided{std::move(records)};

  const auto& first = divided.folds.first.shares[0].weight;
  double large = 0;
  for (Eigen::Index row = 0; row < kFoldRows; ++row)
    large += u[static_cast<std::size_t>(row)] > 0.5 ? first[row] : 0;
  EXPECT_EQ(large, kFoldRows / 4);
}

TEST(FoldsOf, HaveNoRowsInGaps) {
  auto records = records_for({Use::Fit});
  records[0].gaps = {{15, 45}, {100, 110}};
  const Divided divided{records};

  const auto& both = divided.folds.both.shares[0].weight;
  EXPECT_EQ(both.sum(), kFoldRows - 40);
  EXPECT_TRUE(
      (divided.folds.first.shares[0].weight + divided.folds.second.shares[0].weight == both).all());
  EXPECT_EQ(both.segment(15, 30).sum() + both.segment(100, 10).sum(), 0);
}

}  // namespace
}  // namespace rths::diagnosis

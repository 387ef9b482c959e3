// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/excess.hpp>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kCellRows = 400;
constexpr double kCellStep = 0.01;

Drive drive_of_cells(Index outputs = 1) {
  Drive drive;
  drive.time_step = kCellStep;
  drive.measured = MatrixXd::Zero(kCellRows, outputs);
  return drive;
}

// Four cells of 100 rows. The noise has the mean squares 1 and 3 in two draws: 200 are expected in
// each cell, with a scatter of 100. The residual is 1.9 in the first cell, 1 in the second, 5 in
// the third, 0 in the last.
TEST(Cells, HoldTheEnergyBeyondTheNoise) {
  const auto energies =
      by_row(4, drive_of_cells(), [](Index row, Index) { return std::size_t(row) / 100; });
  VectorXd residual = VectorXd::Zero(kCellRows);
  residual.head(100).setConstant(1.9);
  residual.segment(100, 100).setConstant(1);
  residual.segment(200, 100).setConstant(5);
  const Seen seen{residual,
                  {MatrixXd::Ones(kCellRows, 1), MatrixXd::Constant(kCellRows, 1, std::sqrt(3))}};

  const Cells cells{seen, energies};

  ASSERT_EQ(cells.size(), 4U);
  EXPECT_NEAR(cells.beyond_noise(0), 161, 1e-9);
  EXPECT_NEAR(cells.beyond_noise(1), -100, 1e-9);
  EXPECT_NEAR(cells.beyond_noise(2), 2300, 1e-9);
  EXPECT_NEAR(cells.signal_share(0), 161.0 / 361, 1e-12);
  EXPECT_EQ(cells.signal_share(1), 0);
  EXPECT_TRUE(cells.is_empty(3));
  // Only the third cell exceeds the noise by more than twice its scatter.
  EXPECT_NEAR(cells.shares()[2], 1, 1e-12);
  EXPECT_NEAR(cells.shares()[0], 161.0 / 2300, 1e-12);
  EXPECT_EQ(cells.place(), (std::vector<bool>{false, false, true, false}));
}

TEST(ByRow, CountsRowsFromTheFirstOnAndCellsInsideOnly) {
  Drive drive = drive_of_cells(2);
  drive.first_row = 390;
  const auto energies = by_row(2, drive, [](Index row, Index output) {
    return row == 399 ? std::size_t{7} : std::size_t(output);
  });
  MatrixXd signal = MatrixXd::Ones(kCellRows, 2);
  signal.col(1) *= 3;

  EXPECT_EQ(energies(signal), (Energies{9, 81}));
}

// Parseval: the bands together hold Σ x², and a sine lies in the band of its frequency. Padding
// spreads it: of a rectangular window, 1 - 2/(π² d) lies within d bins of the record, here 16.
TEST(Bands, DivideTheEnergyByFrequency) {
  const Bands bands{{0, 6, 14, 51}, drive_of_cells()};
  const VectorXd x = sine_of(40, kCellRows);  // 10 Hz in 4 s

  const Energies energies = bands.energies(x);

  EXPECT_NEAR(energies[0] + energies[1] + energies[2], 400, 1e-9);
  EXPECT_GT(energies[1], 400 * (1 - 2 / (9.87 * 16)));
  const MatrixXd kept = bands.weighed(x, {0, 1, 0}), all = bands.weighed(x, {1, 1, 1});
  EXPECT_LT((all - x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(kept.squaredNorm(), 400 * (1 - 2 * 2 / (9.87 * 16)));
  EXPECT_LT(bands.weighed(x, {1, 0, 1}).squaredNorm(), 400 * 2 / (9.87 * 16));
}

// y = a + 2 b + 7: a is fitted, an offset is free, so that 2 b remains, divided by the noise.
TEST(SeenAt, IsTheResidualThatNoFreeParameterExplains) {
  LinearRelation relation;
  relation.deviation = {0.5};
  relation.offsets = true;
  const VectorXd a = sine_of(3, kCellRows), b = sine_of(5, kCellRows);
  const std::vector<Record> records{
      linear_record("one", Use::Fit, kCellStep, ((a + 2 * b).array() + 7).matrix(), {{"a", a}})};
  const Problem problem = linear_problem(relation, records);

  const Seen seen = seen_at(problem, linear_model({"a"}, {-4}));

  EXPECT_LT((seen.residual - 4 * b).cwiseAbs().maxCoeff(), 1e-10);
  ASSERT_FALSE(seen.noise.empty());
  for (const auto& noise : seen.noise) {
    EXPECT_LT(std::abs(noise.cwiseProduct(a).sum()), 1e-9);
    EXPECT_LT(std::abs(noise.sum()), 1e-9);
  }
}

// The contribution that another model lacks is exact: 2 b.
TEST(SeenAt, OfACompleteModelHasNoNoise) {
  LinearRelation relation;
  const VectorXd a = sine_of(3, kCellRows), b = sine_of(5, kCellRows);
  const std::vector<Record> records{linear_record(
      "one", Use::Fit, kCellStep, a + 2 * b + gauss(kCellRows, 1, 1), {{"a", a}, {"b", b}})};
  const Problem problem = linear_problem(relation, records);

  const Seen seen = seen_at(problem, linear_model({"a"}, {1}), linear_model({"a", "b"}, {0.9, 2}));

  EXPECT_LT((seen.residual - 2 * b).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_TRUE(seen.noise.empty());
}

}  // namespace
}  // namespace rths::diagnosis

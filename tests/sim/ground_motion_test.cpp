// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/sim/ground_motion.hpp>
#include <rths/sim/motion_file.hpp>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

TEST(ColumnReader, ReadsColumnsWithAnySeparator) {
  const test::TemporaryFolder folder;
  const auto commas = folder.write("a.csv", "t_s,h1_g,h2_g\n0.00,1,2\n0.02,3,4\n0.04,5,6\n");
  const auto blanks = folder.write("b.txt", "# time a b\n0.00 1 2\n0.02\t3 4\n\n0.04  5  6\n");

  for (const auto& file : {commas, blanks}) {
    const auto record = read_column(file, 2);
    EXPECT_NEAR(record.time_step, 0.02, 1e-12);
    EXPECT_EQ(record.values, (std::vector<double>{2, 4, 6}));
  }
}

TEST(ColumnReader, ReportsTheLineOfAnError) {
  const test::TemporaryFolder folder;
  const auto uneven = folder.write("u.csv", "0.00,1\n0.02,3\n0.05,5\n0.06,2\n");
  const auto narrow = folder.write("n.csv", "0.00,1\n0.02,3\n");
  const auto broken = folder.write("b.csv", "0.00,1\n0.02,3x\n");
  const auto back = folder.write("r.csv", "0.02,1\n0.00,3\n");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(read_column(uneven, 1)); }),
            uneven.string() + ":3: time is not equally spaced");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(read_column(narrow, 2)); }),
            narrow.string() + ":1: 2 columns found, expected column 2 (0 is time)");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(read_column(broken, 1)); }),
            broken.string() + ":2: '3x' is not a number");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(read_column(back, 1)); }),
            back.string() + ":2: time does not increase");
}

TEST(GroundMotion, IsLinearBetweenSamplesAndZeroOutside) {
  const GroundMotion motion{0.02, {0, 1, 3}, {0, -2, 0}};

  EXPECT_DOUBLE_EQ(motion.at(0.03)[0], 2);
  EXPECT_DOUBLE_EQ(motion.at(0.01)[1], -1);
  EXPECT_EQ(motion.at(-0.01), Eigen::Vector2d::Zero());
  EXPECT_EQ(motion.at(0.05), Eigen::Vector2d::Zero());
  EXPECT_EQ(motion.at(std::nan("")), Eigen::Vector2d::Zero());
  EXPECT_DOUBLE_EQ(motion.at(0.04)[0], 3);
}

TEST(GroundMotion, InterpolatesInRealTime) {
  const GroundMotion motion{0.02, {0, 1, 3}, {0, -2, 0}};
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  EXPECT_REALTIME(a = motion.at(0.033));
  EXPECT_GT(a[0], 0);
}

TEST(CommittedRecord, HasThePeaksThatItsSourcePrints) {
  const auto file = test::source_tree() / "examples/records/petrolia_1992_riodell_freefield.csv";
  const auto peak = [&](int column) {
    double largest = 0;
    for (const double value : read_column(file, column).values)
      largest = std::max(largest, std::abs(value));
    return largest;
  };

  EXPECT_NEAR(peak(1), 0.385, 0.001);
  EXPECT_NEAR(peak(2), 0.549, 0.001);
  EXPECT_NEAR(peak(3), 0.195, 0.001);
}

}  // namespace
}  // namespace rths::sim

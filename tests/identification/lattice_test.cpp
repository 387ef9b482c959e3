// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/lattice.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

// A sine of mean square 1, rounded to whole steps. Of 2000 samples over two cycles, it changes by
// at most 0.009 between two of them, so that it repeats at most values if a step is 0.05.
Record rounded(const std::string& role, double step) {
  Record record;
  record.name = "one";
  record.time_step = 0.01;
  record.channels = {{role, "m", {}}};
  for (const double value : sine_of(2, 2000))
    record.channels[0].values.push_back(step > 0 ? step * std::round(value / step) : value);
  return record;
}

TEST(CoarseLattices, HaveTheStepOfTheSamples) {
  const Record record = rounded("displacement.long", 0.05);

  const auto lattices = coarse_lattices({&record});

  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_EQ(lattices[0].role, "displacement.long");
  EXPECT_EQ(lattices[0].unit, "m");
  EXPECT_NEAR(lattices[0].step, 0.05, 1e-12);
  EXPECT_EQ(lattices[0].on_steps, 1);
}

// Steps of 0.0512 printed with three digits: each change has an error of up to 0.001. The smallest
// change would be 0.051.
TEST(CoarseLattices, HaveTheStepOfPrintedSamples) {
  Record record = rounded("displacement.long", 0.0512);
  for (double& value : record.channels[0].values) value = std::round(1e3 * value) / 1e3;

  const auto lattices = coarse_lattices({&record});

  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_GT(lattices[0].deviation, 0);
  EXPECT_LT(lattices[0].deviation, 1e-4);
  EXPECT_NEAR(lattices[0].step, 0.0512, 3 * lattices[0].deviation);
}

TEST(CoarseLattices, AreNotInSmoothOrFineSamples) {
  const Record smooth = rounded("displacement.long", 0);
  const Record fine = rounded("displacement.long", 0.004);  // less than 0.005 of the deviation
  const Record command = rounded("command.long", 0.05);

  EXPECT_TRUE(coarse_lattices({&smooth}).empty());
  EXPECT_TRUE(coarse_lattices({&fine}).empty());
  EXPECT_TRUE(coarse_lattices({&command}).empty());
}

TEST(CoarseLattices, AreInAllRecords) {
  const Record coarse = rounded("displacement.long", 0.05);
  const Record smooth = rounded("displacement.long", 0);

  EXPECT_TRUE(coarse_lattices({&coarse, &smooth}).empty());
  EXPECT_EQ(coarse_lattices({&coarse, &coarse}).size(), 1U);
}

}  // namespace
}  // namespace rths::diagnosis

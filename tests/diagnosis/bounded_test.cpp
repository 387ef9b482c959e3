// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/bounded.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace rths::diagnosis {
namespace {

// A sine, sampled at 1 kHz.
Case long_case(std::size_t samples, double frequency) {
  Case c;
  c.model.kind = ModelKind::Linear;
  for (const Use use : {Use::Fit, Use::HeldOut}) {
    Record record;
    record.name = name_of(use);
    record.use = use;
    record.time_step = 1e-3;
    record.settle = 2;
    record.quiet = {0, 1000};
    Channel input{"input.u", "N", {}};
    for (std::size_t i = 0; i < samples; ++i)
      input.values.push_back(
          std::sin(2 * std::numbers::pi * frequency * 1e-3 * static_cast<double>(i)));
    record.channels = {input};
    c.records.push_back(record);
  }
  return c;
}

TEST(BoundRecords, LeavesRecordsWithinTheBudget) {
  Case c = long_case(50'000, 1);

  EXPECT_TRUE(bound_records(c).empty());
  EXPECT_EQ(c.records[0].samples(), 50'000U);
}

TEST(BoundRecords, ThinsWhatIsSampledFarAboveItsFrequencies) {
  Case c = long_case(150'000, 1);

  const auto lost = bound_records(c);

  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(
      lost[0],
      "fit: thinned to one of 3 samples, 333.3 Hz, behind a low-pass filter, to bound the time "
      "of the diagnosis.");
  EXPECT_EQ(c.records[0].samples(), 50'000U);
  EXPECT_DOUBLE_EQ(c.records[0].time_step, 3e-3);
  EXPECT_EQ(c.records[0].quiet->second, 333U);
  EXPECT_NEAR(c.records[0].channels[0].values[1000], std::sin(2 * std::numbers::pi * 3), 1e-4);
}

TEST(BoundRecords, CutsWhatMayNotBeThinned) {
  Case c = long_case(100'000, 100);

  const auto lost = bound_records(c);

  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(lost[1],
            "held_out: only the first 50000 of 100000 samples are used, to bound the time of the "
            "diagnosis; select a section with span_s.");
  EXPECT_EQ(c.records[1].samples(), 50'000U);
  EXPECT_DOUBLE_EQ(c.records[1].time_step, 1e-3);
}

TEST(BoundRecords, DoesNotThinRecordsOfAStatedNoise) {
  Case c = long_case(100'000, 1);
  c.noise = {{"input.u", 0.1}};

  EXPECT_EQ(bound_records(c).size(), 2U);
  EXPECT_DOUBLE_EQ(c.records[0].time_step, 1e-3);
  EXPECT_EQ(c.records[0].samples(), 50'000U);
}

}  // namespace
}  // namespace rths::diagnosis

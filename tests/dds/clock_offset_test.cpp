// SPDX-License-Identifier: Apache-2.0
#include "broker/dds/src/clock_offset.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace rths::dds {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// An exchange: our message takes `there`, rests for `rest`, and the answer takes `back`.
void exchange(ClockOffset& clock, TimePoint begun, Duration offset, Duration there, Duration rest,
              Duration back) {
  clock.add(begun, begun + there + offset, begun + there + rest + offset,
            begun + there + rest + back);
}

TEST(ClockOffset, IsUnknownBeforeTheFirstExchange) {
  EXPECT_FALSE(ClockOffset{}.at(TimePoint{0}).has_value());
}

TEST(ClockOffset, IsExactIfBothDirectionsTakeEquallyLong) {
  for (const Duration offset : {Duration{hours{1}}, -Duration{hours{1}}, Duration{17}}) {
    ClockOffset clock;
    const TimePoint now = hours{2};
    exchange(clock, now, offset, microseconds{100}, milliseconds{30}, microseconds{100});
    const auto estimate = clock.at(now);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_EQ(estimate->offset, offset);
    EXPECT_NEAR(to_seconds(estimate->error), 100e-6, 10e-6);  // and the drift of 30 ms
  }
}

// Times in the two directions are random and unequal, and the clocks drift by 50 ppm.
TEST(ClockOffset, DiffersFromTheTruthByAtMostItsError) {
  std::mt19937_64 random{20261123};
  std::exponential_distribution<double> trip{1 / 300e-6};
  ClockOffset clock;
  double largest_share = 0;
  for (int i = 0; i < 5000; ++i) {
    const TimePoint now = seconds{100} + i * milliseconds{50};
    const double drift = 50e-6 * to_seconds(now);
    const Duration truth = from_seconds(3.5 + drift);
    exchange(clock, now, truth, from_seconds(50e-6 + trip(random)), milliseconds{20},
             from_seconds(50e-6 + trip(random)));
    const auto estimate = clock.at(now);
    ASSERT_TRUE(estimate.has_value());
    const double wrong = std::abs(to_seconds(estimate->offset - truth));
    ASSERT_LE(wrong, to_seconds(estimate->error)) << i;
    largest_share = std::max(largest_share, wrong / to_seconds(estimate->error));
  }
  EXPECT_GT(largest_share, 0.3);  // the bound is not idle
  EXPECT_LT(to_seconds(clock.at(seconds{100} + 5000 * milliseconds{50})->error), 400e-6);
}

TEST(ClockOffset, IgnoresTimesThatCannotBeTrue) {
  ClockOffset clock;
  constexpr TimePoint kHuge{std::numeric_limits<std::int64_t>::max()};
  constexpr TimePoint kLowest{std::numeric_limits<std::int64_t>::min()};
  for (const TimePoint bad : {kHuge, kLowest, TimePoint{-1}}) {
    clock.add(bad, seconds{1}, seconds{1}, seconds{1});
    clock.add(seconds{1}, bad, seconds{1}, seconds{1});
    clock.add(seconds{1}, seconds{1}, bad, seconds{1});
  }
  clock.add(seconds{2}, seconds{1}, seconds{1}, seconds{1});   // sent in the future
  clock.add(seconds{1}, seconds{9}, seconds{8}, seconds{2});   // answered before it arrived
  clock.add(seconds{1}, seconds{1}, seconds{9}, seconds{2});   // a round trip of less than nothing
  clock.add(seconds{1}, seconds{1}, seconds{1}, seconds{60});  // too long to say anything
  EXPECT_FALSE(clock.at(seconds{60}).has_value());
}

}  // namespace
}  // namespace rths::dds

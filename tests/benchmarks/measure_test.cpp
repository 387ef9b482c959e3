// SPDX-License-Identifier: Apache-2.0
//
// Properties of a measurement that do not depend on times.
#include <rths/bench/judge.hpp>
#include <rths/bench/round_trip.hpp>
#include <rths/bench/rows.hpp>

#include <set>

#include <gtest/gtest.h>

#include "benchmarks/ring/src/peer_rows.hpp"
#include "support/files.hpp"

namespace rths::bench {
namespace {

using test::error_of;

// On a host with one processor both sides share it; no test depends on times.
Setup short_setup() {
  const auto chosen = describe_machine().chosen;
  return {chosen ? chosen->cpus : Cpus{0, 0}, 10, 1};
}

struct FailingEnd {
  explicit FailingEnd(Side side) {
    if (side == Side::Far) throw Error{"cannot start"};
  }
  void send(std::uint32_t) {}
  [[nodiscard]] bool arrived(std::uint32_t) const { return false; }
};

TEST(Partner, PassesOnTheErrorOfItsWork) {
  Partner partner{short_setup().cpus.far, [] { throw Error{"the work failed"}; }};

  const std::string error = error_of([&] { partner.join(); });

  EXPECT_NE(error.find("the work failed"), std::string::npos) << error;
}

TEST(Partner, EndsWithoutAnErrorIfItsWorkSucceeds) {
  const Shared<std::atomic<std::uint32_t>> seen;
  Partner partner{short_setup().cpus.far, [&] { seen->store(7); }};

  partner.join();

  EXPECT_EQ(seen->load(), 7U);
}

TEST(RoundTrips, EndWithTheReasonIfTheOtherSideCannotStart) {
  const std::string error = error_of([] {
    static_cast<void>(round_trips(short_setup(), [](Side side) { return FailingEnd{side}; }));
  });

  EXPECT_NE(error.find("cannot start"), std::string::npos) << error;
}

TEST(RoundTrips, GiveHalfOfATripAndLeaveOutTheFirstTenth) {
  std::vector<std::uint64_t> trips(100, 300);
  for (std::size_t i = 0; i < 10; ++i) trips[i] = 1'000'000;

  const Times times = one_way(trips, 2.0);

  EXPECT_DOUBLE_EQ(times.p50, 300);
  EXPECT_DOUBLE_EQ(times.p99, 300);
}

TEST(PeerLine, GivesTheTimes) {
  const Times times = parse_peer_line("{\"p50_ns\": 150.5, \"p99_ns\": 200}\n");

  EXPECT_DOUBLE_EQ(times.p50, 150.5);
  EXPECT_DOUBLE_EQ(times.p99, 200);
}

TEST(PeerLine, PassesOnThePeersError) {
  EXPECT_EQ(error_of([] { static_cast<void>(parse_peer_line("{\"error\": \"no daemon\"}")); }),
            "no daemon");
}

TEST(PeerLine, IsRefusedInAnyOtherFormat) {
  for (const char* line : {"", "150 200", "[1, 2]", "{\"p50_ns\": 1}"})
    EXPECT_NE(error_of([&] { static_cast<void>(parse_peer_line(line)); }), "") << line;
}

TEST(Rows, HaveDifferentNames) {
  std::set<std::string> names;
  for (const Row& row : all_rows()) EXPECT_TRUE(names.insert(row.name).second) << row.name;
}

TEST(Rows, IncludeTheRowThatAPeerIsComparedWith) {
  const auto rows = select_rows({"iceoryx_64"});

  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].name, "group_64");
  EXPECT_EQ(rows[1].name, "iceoryx_64");
}

TEST(Rows, HaveGoalsThatSatisfyTheirLimits) {
  for (const Row& row : all_rows()) {
    if (!row.gate) continue;
    EXPECT_TRUE(holds(row.quantity, row.gate->goal, row.gate->limit)) << row.name;
  }
}

}  // namespace
}  // namespace rths::bench

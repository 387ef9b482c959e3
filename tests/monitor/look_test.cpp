// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/look.hpp>

#include <chrono>
#include <cmath>
#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/assign.hpp>

#include "monitor/laboratory.hpp"
#include "support/host_time.hpp"
#include "support/ring_maps.hpp"

namespace rths::monitor {
namespace {

using test::Laboratory;
using test::unique_ring;

constexpr std::size_t kHistory = 1 << 22;  // more than 10 s of slots

// Updates as the page does. @returns false if it is not so after some seconds
bool becomes(RingLook& look, const std::function<bool()>& is_so, double seconds = 10) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < until) {
    look.update();
    if (is_so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  return false;
}

void update_for(RingLook& look, double seconds) {
  becomes(
      look, [] { return false; }, seconds);
}

TEST(Look, HasEachWriteOfANodeInItsHistory) {
  const Laboratory laboratory{unique_ring("history")};
  RingLook look{unique_ring("history"), kHistory};
  update_for(look, 2.5);
  const History& history = *look.history();
  std::vector<Extent> second(1), slots(1000);
  const Slot from = (look.begun() / kSlot / 1024 + 1) * 1024;

  history.reduce(*look.find("monitor.xpc.pc.command.long"), from, 10, second);
  history.reduce(*look.find("monitor.xpc.host.step"), from, 0, slots);

  EXPECT_NEAR(second[0].low, -0.01, 1e-6);
  EXPECT_NEAR(second[0].high, 0.01, 1e-6);
  // Steps are never left out between two slots, whichever the scheduler delays.
  for (std::size_t i = 1; i < slots.size(); ++i) {
    ASSERT_LE(slots[i].low, slots[i - 1].high + 1) << i;
    ASSERT_GE(slots[i].high, slots[i - 1].high) << i;
  }
  EXPECT_EQ(look.nodes()[0].lost, 0U);
}

TEST(Look, MeasuresRatesOfHeartbeatsAndWrites) {
  const Laboratory laboratory{unique_ring("rates"), 3};
  RingLook look{unique_ring("rates"), 0};
  const auto steps = laboratory.steps();
  const auto begun = std::chrono::steady_clock::now();
  update_for(look, 2);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const double rate = static_cast<double>(laboratory.steps() - steps) / seconds;

  for (const auto& node : look.nodes()) {
    if (node.name != "srmd" && node.name != "xpc") continue;
    EXPECT_NEAR(node.rate, rate, 0.1 * rate) << node.name;
    EXPECT_EQ(node.presence.state, broker::Presence::State::Alive);
  }
  EXPECT_NEAR(look.nodes()[0].writes, 4 * rate, 0.4 * rate);  // a group and three words
}

TEST(Look, TellsATripAndItsCause) {
  Laboratory laboratory{unique_ring("trip")};
  RingLook look{unique_ring("trip"), 0};
  ASSERT_TRUE(becomes(look, [&] { return look.safety().at(0).state == "running"; }));
  EXPECT_EQ(look.safety().at(0).trip, "");

  laboratory.trip();

  ASSERT_TRUE(becomes(look, [&] { return !look.safety().at(0).trip.empty(); }));
  EXPECT_EQ(look.safety().at(0).trip,
            "long: velocity of the command is 2.1 m/s, expected at most 1.8 m/s");
  const auto is_trip = [](const RingEvent& event) {
    return event.is_bad && event.text.find("tripped: long: velocity") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(look.events().begin(), look.events().end(), is_trip), 1);
}

TEST(Look, ListsAWordThatChangesOftenOnce) {
  const Laboratory laboratory{unique_ring("often")};
  RingLook look{unique_ring("often"), 0};
  auto operated = broker::Ring::attach(unique_ring("often"));

  for (const char* gain : {"1.5", "1.6", "1.7"}) {
    broker::assign(operated, {std::string{"tune.srmd.gain="} + gain});
    update_for(look, 0.3);
  }

  const auto is_gain = [](const RingEvent& event) { return event.word == "tune.srmd.gain"; };
  EXPECT_EQ(std::count_if(look.events().begin(), look.events().end(), is_gain), 1);
  EXPECT_EQ(look.events().back().text, "tune.srmd.gain: 1 to 1.7");
}

TEST(Look, FindsAStoreIntoAWordOfAnotherNode) {
  const Laboratory laboratory{unique_ring("violation"), 1};
  RingLook look{unique_ring("violation"), 0};
  auto other = broker::Ring::attach(unique_ring("violation"));
  broker::Node client = other.join_plain("");

  client.plain_memory()[32] = 7;  // the parameter, which nobody writes

  ASSERT_TRUE(becomes(look, [&] { return !look.violations().empty(); }));
  const auto& found = look.violations().begin()->second;
  EXPECT_EQ(found.word, "tune.srmd.gain");
  EXPECT_EQ(found.owner, "operator");
}

TEST(Look, SeesTheEndOfARing) {
  std::optional<Laboratory> laboratory{std::in_place, unique_ring("end")};
  RingLook look{unique_ring("end"), 0};
  look.update();
  EXPECT_TRUE(look.is_current());

  laboratory.reset();

  look.update();
  EXPECT_FALSE(look.is_current());
}

TEST(Look, WritesItsStateAsTextAndJson) {
  const Laboratory laboratory{unique_ring("text")};
  RingLook look{unique_ring("text"), 0};
  update_for(look, 1.2);

  const std::string text = text_of(look), json = json_of(look);

  EXPECT_NE(text.find("safety layer of srmd: running"), std::string::npos) << text;
  EXPECT_NE(text.find("xpc            alive"), std::string::npos) << text;
  EXPECT_NE(json.find("\"node\":\"xpc\",\"state\":\"alive\""), std::string::npos) << json;
}

}  // namespace
}  // namespace rths::monitor

// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/play.hpp>

#include <unistd.h>

#include <atomic>
#include <future>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/waiting.hpp"

namespace rths::testkit {
namespace {

using rths::test::comes_true;
using rths::test::error_of;

constexpr int kRows = 50;
constexpr double kInterval = 0.002;  // [s]

memmap::Map two_signal_map() {
  return memmap::load_map(test::source_tree() / "examples/python/two_signals.ringmap.toml");
}

// Of the row; none is a whole number of millimetres or kilonewtons.
double displacement(int row) { return 0.0105 + 0.001 * row; }
double force(int row) { return 500.5 + 1000 * (row / 2); }

class PlayedRecording : public testing::Test {
 protected:
  PlayedRecording() {
    const memmap::Map map = two_signal_map();
    recording::Writer writer{settings.recording,
                             map,
                             {map.signal("solver.displacement"), map.signal("machine.force")},
                             {}};
    for (int i = 0; i < kRows; ++i)
      writer.append(from_seconds(1 + kInterval * i), std::vector{displacement(i), force(i)});
    writer.close();
  }
  /// Every write to a word, in their order, while the recording is played. [SI]
  std::vector<double> writes_to(const std::string& signal) {
    auto ring = broker::Ring::create(settings.ring, two_signal_map());
    const auto& entry = ring.map().entry(ring.map().signal(signal));
    auto follower = ring.follow(entry.partition->node);
    played = play(settings, [] { return false; });
    std::vector<double> values;
    broker::Write write;
    while (follower.next(write) == broker::Followed::Write)
      if (write.offset == entry.signal->offset)
        values.push_back(memmap::Codec{*entry.signal}.decode(write.value));
    broker::remove_ring(settings.ring);
    return values;
  }
  [[nodiscard]] std::string error() const {
    return error_of([&] { static_cast<void>(play(settings, [] { return false; })); });
  }
  [[nodiscard]] bool is_ring_there() const {
    return broker::inspect_ring(settings.ring).has_value();
  }

  const test::TemporaryFolder folder;
  PlaySettings settings{
      folder.path() / "run.h5", {"solver"}, fmt::format("play_test_{}", getpid()), 1, {}, {}, 5};
  Played played;
};

TEST_F(PlayedRecording, GivesEveryRecordedWordOnceInItsOrder) {
  const auto values = writes_to("solver.displacement");

  ASSERT_EQ(values.size(), kRows);
  for (int i = 0; i < kRows; ++i)
    EXPECT_NEAR(values[static_cast<std::size_t>(i)], displacement(i), 1e-8);
  EXPECT_TRUE(played.is_complete);
}

TEST_F(PlayedRecording, WritesAWordOnlyWhenItChanges) {
  settings.nodes = {"machine"};

  EXPECT_EQ(writes_to("machine.force").size(), kRows / 2);
}

TEST_F(PlayedRecording, LeavesTheWordsOfOtherNodes) {
  EXPECT_TRUE(writes_to("machine.force").empty());
}

TEST_F(PlayedRecording, LastsAsLongAsTheRecordingTimesTheRate) {
  settings.rate = 3;
  const WallClock clock;
  const TimePoint begun = clock.now();
  static_cast<void>(play(settings, [] { return false; }));

  EXPECT_GE(to_seconds(clock.now() - begun), 3 * kInterval * (kRows - 1));
}

TEST_F(PlayedRecording, HasTheFaultsOfATest) {
  settings.faults = {"kind=flip signal=solver.displacement bit=31 at_s=1.02 for_s=0.0015"};
  const auto values = writes_to("solver.displacement");

  EXPECT_NEAR(values[9], displacement(9), 1e-8);
  EXPECT_NEAR(values[10], -displacement(10), 1e-8);
  EXPECT_NEAR(values[11], displacement(11), 1e-8);
}

TEST_F(PlayedRecording, DropsAWord) {
  settings.faults = {"kind=drop node=solver at_s=1.02 for_s=0.0015"};

  EXPECT_EQ(writes_to("solver.displacement").size(), kRows - 1);
}

TEST_F(PlayedRecording, BeginsWhenAnAwaitedNodeIsThere) {
  settings.awaited = {"machine"};
  settings.longest_wait = 20;
  auto ended = std::async(std::launch::async, [&] { return play(settings, [] { return false; }); });
  ASSERT_TRUE(comes_true([&] { return is_ring_there(); }));
  auto ring = broker::Ring::attach(settings.ring);
  const auto before = ring.observe().read(LongwordOffset{0});
  const auto machine = ring.join("machine", 0);

  EXPECT_EQ(before, 0U);
  EXPECT_TRUE(ended.get().is_complete);
}

TEST_F(PlayedRecording, IsRefusedInOneLineAndLeavesNothing) {
  settings.nodes = {"sensor"};
  EXPECT_EQ(error(),
            settings.recording.string() +
                ": map 'two_signals' has no node 'sensor', expected one of solver, machine");
  settings.nodes = {"solver"};
  settings.faults = {"kind=flip signal=machine.force bit=1"};
  EXPECT_EQ(error(), "fault 'kind=flip signal=machine.force bit=1': node 'machine' is not played");
  settings.faults = {"flip"};
  EXPECT_EQ(error(), "fault 'flip': expected key=value, found 'flip'");
  settings.faults = {""};
  EXPECT_EQ(error(), "fault '': 'kind' is missing");
  settings.faults = {"kind=flip signal=solver.displacement bit=99"};
  EXPECT_EQ(error(),
            "fault 'kind=flip signal=solver.displacement bit=99': bit is 99, expected 0 to 31");
  settings.faults = {"kind=flip signal=solver.displacement bit=07 at_s=x"};
  EXPECT_EQ(error(),
            "fault 'kind=flip signal=solver.displacement bit=07 at_s=x': at_s is a string, "
            "expected a number");
  settings.faults = {"kind=flip signal=nothing bit=1"};
  EXPECT_EQ(error(),
            "fault 'kind=flip signal=nothing bit=1': map 'two_signals' has no signal 'nothing'");
  settings.faults = {};
  settings.awaited = {"machine"};
  settings.longest_wait = 0;
  EXPECT_EQ(error(), "node 'machine' was not on ring '" + settings.ring + "' within 0 s");
  settings.recording = folder.write("run.csv", "time,x\n0,1\n");
  EXPECT_NE(error().find("run.csv: is damaged or no recording"), std::string::npos);
  EXPECT_FALSE(is_ring_there());
}

TEST_F(PlayedRecording, IsRefusedByARingWithAnotherMap) {
  const auto ring = broker::Ring::create(
      settings.ring, memmap::load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml"));

  EXPECT_EQ(error(),
            "ring '" + settings.ring +
                "' has the map 'srmd', in which 'solver.displacement' is no word, expected "
                "that of the recording");
  broker::remove_ring(settings.ring);
}

TEST_F(PlayedRecording, IsRefusedWhileItIsWritten) {
  const memmap::Map map = two_signal_map();
  settings.recording = folder.path() / "growing.h5";
  const recording::Writer writer{settings.recording, map, {map.signal("machine.force")}, {}};

  EXPECT_NE(error().find("growing.h5: is still written, expected a finished recording"),
            std::string::npos);
}

/// A controller whose ticks are counted by the word of the machine, and a recording of such a one.
class CountedRecording : public PlayedRecording {
 protected:
  static constexpr int kTicks = 20;

  CountedRecording() {
    settings.counter = kCounter;
    std::filesystem::remove(settings.recording);
  }
  /// @param rows_between  a row before each tick and one after it; else a row after each tick
  void record(bool rows_between) {
    const memmap::Map map = two_signal_map();
    recording::Writer writer{
        settings.recording, map, {map.signal("solver.displacement"), map.signal(kCounter)}, {}};
    double time = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
      if (rows_between)
        writer.append(from_seconds(time += 4e-4), std::vector{displacement(tick), 1.0 * tick});
      writer.append(from_seconds(time += 6e-4), std::vector{displacement(tick), tick + 1.0});
    }
    writer.close();
  }
  /// What the controller reads in each tick [m]. It ticks late, and now and then very late.
  std::vector<double> read_in_ticks() {
    auto ring = broker::Ring::create(settings.ring, two_signal_map());
    auto controller = ring.join("machine", 0);
    auto ended =
        std::async(std::launch::async, [&] { return play(settings, [] { return false; }); });
    std::vector<double> read;
    for (int tick = 0; tick < kTicks; ++tick) {
      const auto before = read.empty() ? 0 : read.back();
      EXPECT_TRUE(comes_true([&] { return displacement_on(ring, controller) != before; }));
      std::this_thread::sleep_for(std::chrono::milliseconds{tick % 8 == 7 ? 20 : 3});
      read.push_back(displacement_on(ring, controller));
      count(ring, controller, tick + 1);
    }
    played = ended.get();
    broker::remove_ring(settings.ring);
    return read;
  }
  static double displacement_on(const broker::Ring& ring, const broker::Node& node) {
    const auto& entry = ring.map().entry(ring.map().signal("solver.displacement"));
    return memmap::Codec{*entry.signal}.decode(node.read(entry.signal->offset));
  }
  static void count(const broker::Ring& ring, broker::Node& node, int ticks) {
    const auto& entry = ring.map().entry(ring.map().signal(kCounter));
    static_cast<void>(node.write(entry.signal->offset, memmap::Codec{*entry.signal}.encode(ticks)));
  }
  static constexpr const char* kCounter = "machine.force";
};

class PlayedInStep : public CountedRecording, public testing::WithParamInterface<bool> {};

TEST_P(PlayedInStep, GivesEachTickItsRecordedWordsHoweverLateItIs) {
  record(GetParam());
  const auto read = read_in_ticks();

  for (int tick = 0; tick < kTicks; ++tick)
    EXPECT_NEAR(read[static_cast<std::size_t>(tick)], displacement(tick), 1e-8);
  EXPECT_TRUE(played.is_complete);
  EXPECT_GE(played.ticks, kTicks);
  EXPECT_EQ(played.late_ticks, 0U);
}
INSTANTIATE_TEST_SUITE_P(RowsBetweenTicks, PlayedInStep, testing::Bool());

TEST_F(CountedRecording, CountsTheTicksThatCameBeforeTheirWords) {
  record(true);
  auto ring = broker::Ring::create(settings.ring, two_signal_map());
  auto controller = ring.join("machine", 0);
  auto ended = std::async(std::launch::async, [&] { return play(settings, [] { return false; }); });
  ASSERT_TRUE(comes_true([&] { return displacement_on(ring, controller) != 0; }));
  count(ring, controller, kTicks);
  played = ended.get();
  broker::remove_ring(settings.ring);

  EXPECT_TRUE(played.is_complete);
  EXPECT_GE(played.late_ticks, kTicks - 2U);
}

TEST_F(CountedRecording, EndsIfATickIsNotInTime) {
  record(true);
  settings.longest_wait = 0.02;

  EXPECT_EQ(error(), "counter 'machine.force' of ring '" + settings.ring +
                         "' is 0, expected 1 within 0.02 s");
}

TEST_F(CountedRecording, IsNotInStepWithItself) {
  record(true);
  settings.nodes = {"machine"};

  EXPECT_EQ(error(), "counter 'machine.force' is written by node 'machine', which is played");
}

/// A ring whose writes are recorded in another thread.
class RecordedRing : public PlayedRecording {
 protected:
  void begin() {
    ring.emplace(broker::Ring::create(settings.ring, two_signal_map()));
    recorded = std::async(std::launch::async, [this] {
      return record_ring(settings.ring, file, 1e-4, [this] { return ends.load(); });
    });
    ASSERT_TRUE(comes_true([this] { return std::filesystem::exists(file); }));
  }

  const std::filesystem::path file = folder.path() / "ring.h5";
  std::atomic<bool> ends{false};
  std::optional<broker::Ring> ring;
  std::future<RingRecording> recorded;
};

TEST_F(RecordedRing, HasEveryWordAndCountsThem) {
  begin();
  static_cast<void>(play(settings, [] { return false; }));
  ends = true;
  const auto result = recorded.get();
  const recording::Reader run{file};
  const auto values = run.signal("solver.displacement");

  EXPECT_EQ(result.writes, kRows);
  EXPECT_EQ(result.missing, 0U);
  EXPECT_EQ(result.rows, run.rows());
  ASSERT_EQ(values.size(), kRows + 1U);  // and that of the begin
  for (int i = 0; i < kRows; ++i)
    EXPECT_NEAR(values[static_cast<std::size_t>(i) + 1], displacement(i), 1e-8);
  EXPECT_EQ(run.meta().at("writes_missing"), "0");
  broker::remove_ring(settings.ring);
}

TEST_F(RecordedRing, EndsWithTheRing) {
  begin();
  broker::remove_ring(settings.ring);

  ASSERT_EQ(recorded.wait_for(std::chrono::seconds{20}), std::future_status::ready);
  EXPECT_EQ(recording::Reader{file}.rows(), 1U);
}

TEST_F(RecordedRing, IsNotRecordedOverAFile) {
  EXPECT_EQ(error_of([&] {
              static_cast<void>(
                  record_ring(settings.ring, settings.recording, 1e-3, [] { return true; }));
            }),
            settings.recording.string() + ": exists already, expected a new file");
}

}  // namespace
}  // namespace rths::testkit

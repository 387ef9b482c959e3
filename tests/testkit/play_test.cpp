// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/play.hpp>

#include <unistd.h>

#include <atomic>
#include <future>

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

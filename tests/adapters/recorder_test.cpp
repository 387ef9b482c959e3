// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/adapters/recorder.hpp>
#include <rths/core/error.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"

namespace rths::adapters {
namespace {

memmap::Map srmd() {
  return memmap::load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
}

class Recording : public ::testing::TestWithParam<bool> {};

TEST_P(Recording, HoldsARowForEveryStep) {
  const test::TemporaryFolder folder;
  RecorderSettings settings;
  settings.file = folder.path() / "run.h5";
  settings.own_thread = GetParam();
  settings.linger = 0.05;
  const auto recorder = make_recorder(srmd(), settings);
  recorder->activate();
  test::Bench bench{*recorder};
  int rows = 0;
  for (; rows < 1500; ++rows) {
    bench.in("srmd.long.displ.fbk") = 0.001 * rows;
    ASSERT_EQ(bench.step(0.001 * rows), Status::Ok);
  }
  while (bench.step(0.001 * rows, true) == Status::Ok) ++rows;
  ++rows;
  recorder->deactivate();

  const recording::Reader reader{settings.file};
  ASSERT_EQ(reader.rows(), static_cast<std::size_t>(rows));
  const auto values = reader.signal("srmd.long.displ.fbk");
  for (std::size_t i = 0; i < 1500; ++i)
    ASSERT_NEAR(values[i], 0.001 * static_cast<double>(i), 1e-12);
  EXPECT_NEAR(reader.time().back() - reader.time()[1499], 0.051, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Thread, Recording, ::testing::Bool(), [](const auto& own) {
  return own.param ? std::string{"own"} : std::string{"caller"};
});

memmap::Map with_safety_layer() {
  memmap::MapDescription description = srmd().description();
  memmap::Partition monitor;
  monitor.name = "monitor.srmd";
  monitor.node = "srmd";
  monitor.base = LongwordOffset{description.size_longwords - 2};
  monitor.longwords = 2;
  memmap::Signal state;
  state.name = "safety.state";
  state.unit = "1";
  state.offset = monitor.base;
  memmap::Signal count = state;
  count.name = "host.step";
  count.offset = LongwordOffset{description.size_longwords - 1};
  monitor.signals = {state, count};
  description.partitions.push_back(monitor);
  return memmap::Map{description};
}

// A recorder that is told to stop at 0, while a safety layer moves its machine until `moving` [s]
// and its node steps until `alive` [s]. @returns its end [s]
double end_of_recorder(double moving, double longest, double alive) {
  const test::TemporaryFolder folder;
  RecorderSettings settings;
  settings.file = folder.path() / "run.h5";
  settings.own_thread = false;
  settings.linger = 0.1;
  settings.longest = longest;
  const auto recorder = make_recorder(with_safety_layer(), settings);
  recorder->activate();
  test::Bench bench{*recorder};
  int ticks = 0;
  do {
    const double time = 0.001 * ticks;
    bench.in("monitor.srmd.safety.state") = std::min(time, alive) < moving ? 4 : 0;
    if (time < alive) bench.in("monitor.srmd.host.step") = ticks;
  } while (bench.step(0.001 * ticks++, true) == Status::Ok);
  recorder->deactivate();
  return 0.001 * ticks;
}

// A stop that returns slowly to rest takes longer than the retreat.
TEST(Recorder, RecordsUntilASafetyLayerIsAtRest) {
  constexpr double kAlive = 100;
  EXPECT_NEAR(end_of_recorder(0, 5, kAlive), 0.1, 0.002);
  EXPECT_NEAR(end_of_recorder(3, 5, kAlive), 3.2, 0.002);
  EXPECT_NEAR(end_of_recorder(9, 5, kAlive), 5, 0.002);
}

// The state of a dead node says for ever that it moves its machine.
TEST(Recorder, DoesNotWaitForASafetyLayerWhoseNodeIsDead) {
  EXPECT_NEAR(end_of_recorder(9, 5, 1), 1 + 0.5 + 0.2, 0.003);
}

// A burst far beyond the queue's two seconds: rows that do not fit are counted and dropped.
TEST(Recorder, CountsTheRowsItLoses) {
  const test::TemporaryFolder folder;
  RecorderSettings settings;
  settings.file = folder.path() / "run.h5";
  const auto recorder = make_recorder(srmd(), settings);
  recorder->activate();
  test::Bench bench{*recorder};
  constexpr int kSteps = 60'000;
  for (int i = 0; i < kSteps; ++i) static_cast<void>(bench.step(0.001 * i));
  recorder->deactivate();

  const auto rows = static_cast<double>(recording::Reader{settings.file}.rows());
  EXPECT_GT(bench.out("lost_rows"), 0);
  EXPECT_EQ(rows + bench.out("lost_rows"), kSteps);
  EXPECT_EQ(recording::Reader{settings.file}.rows_missing(), bench.out("lost_rows"));
}

// After a pause, the values of now would have the times of the pause.
TEST(Recorder, LeavesOutRowsWhoseTimeHasPassed) {
  const test::TemporaryFolder folder;
  RecorderSettings settings;
  settings.file = folder.path() / "run.h5";
  const auto recorder = make_recorder(srmd(), settings);
  recorder->activate();
  test::Bench bench{*recorder};
  for (int i = 0; i < 1000; ++i) {
    const double paused_until = i >= 400 && i < 700 ? 0.7005 : 0;
    bench.in("srmd.long.displ.fbk") = std::max(0.001 * i, paused_until);
    bench.set_age(std::max(0.0, paused_until - 0.001 * i));
    ASSERT_EQ(bench.step(0.001 * i), Status::Ok);
  }
  recorder->deactivate();

  const recording::Reader reader{settings.file};
  const auto values = reader.signal("srmd.long.displ.fbk");
  ASSERT_EQ(values.size(), 700U);
  for (std::size_t row = 0; row < values.size(); ++row)
    ASSERT_NEAR(values[row], reader.time()[row], 1e-6);
  EXPECT_EQ(reader.rows_missing(), 300);
  EXPECT_EQ(bench.out("lost_rows"), 300);
}

TEST(Recorder, SaysWhenItsFileCannotBeMade) {
  RecorderSettings settings;
  settings.file = "/no/such/folder/run.h5";
  const auto recorder = make_recorder(srmd(), settings);

  EXPECT_NE(test::error_of([&] { recorder->activate(); }), "");
}

}  // namespace
}  // namespace rths::adapters

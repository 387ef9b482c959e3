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
}

TEST(Recorder, SaysWhenItsFileCannotBeMade) {
  RecorderSettings settings;
  settings.file = "/no/such/folder/run.h5";
  const auto recorder = make_recorder(srmd(), settings);

  EXPECT_NE(test::error_of([&] { recorder->activate(); }), "");
}

}  // namespace
}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "sample_recording.hpp"
#include "support/files.hpp"

namespace rths::recording {
namespace {

/// A recording of ten rows. @param change  of the values of a row
Reader written(const std::filesystem::path& file,
               const std::function<void(int, std::vector<double>&)>& change = {}) {
  Writer writer = open_writer(file);
  for (int i = 0; i < 10; ++i) {
    auto values = row(i);
    if (change) change(i, values);
    writer.append(time_of(i), values);
  }
  writer.close();
  return Reader{file};
}

void lose_one(int i, std::vector<double>& values) {
  if (i == 4) values[1] = std::numeric_limits<double>::quiet_NaN();
}

TEST(HoldSameSignals, RecognisesACopyWhateverItsFile) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5", copy = folder.path() / "copy.h5";
  const Reader run = written(file, lose_one);
  std::filesystem::copy_file(file, copy);
  const Reader again = written(folder.path() / "again.h5", lose_one);

  EXPECT_TRUE(hold_same_signals(run, Reader{copy}));
  EXPECT_TRUE(hold_same_signals(run, again));
}

TEST(HoldSameSignals, TellsRunsApartByOneValueOrRow) {
  const test::TemporaryFolder folder;
  const Reader run = written(folder.path() / "run.h5");
  const Reader other = written(folder.path() / "other.h5", [](int i, std::vector<double>& values) {
    if (i == 9) values[1] += 1;
  });
  Writer writer = open_writer(folder.path() / "longer.h5");
  write_rows(writer, 0, 11);
  writer.close();

  EXPECT_FALSE(hold_same_signals(run, other));
  EXPECT_FALSE(hold_same_signals(run, written(folder.path() / "lost.h5", lose_one)));
  EXPECT_FALSE(hold_same_signals(run, Reader{folder.path() / "longer.h5"}));
}

}  // namespace
}  // namespace rths::recording

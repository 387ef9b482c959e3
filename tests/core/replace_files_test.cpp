// SPDX-License-Identifier: Apache-2.0
#include <rths/core/replace_files.hpp>

#include <iterator>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"

namespace rths {
namespace {

namespace fs = std::filesystem;

std::ptrdiff_t files_in(const fs::path& folder) {
  return std::distance(fs::directory_iterator{folder}, fs::directory_iterator{});
}

TEST(Replacements, ReplaceTheirFilesTogetherAtTheEnd) {
  const test::TemporaryFolder folder;
  const fs::path one = folder.path() / "one", other = folder.path() / "other",
                 old = folder.path() / "old";
  replace_file(one, "earlier");
  replace_file(old, "earlier");

  Replacements written;
  written.add(one, "new");
  written.add(other, "new");
  written.remove(old);
  EXPECT_EQ(test::content_of(one), "earlier");
  EXPECT_FALSE(fs::exists(other));
  EXPECT_TRUE(fs::exists(old));
  written.commit();

  EXPECT_EQ(test::content_of(one), "new");
  EXPECT_EQ(test::content_of(other), "new");
  EXPECT_EQ(files_in(folder.path()), 2);
}

TEST(Replacements, LeaveEarlierFilesIfTheyAreNotCommitted) {
  const test::TemporaryFolder folder;
  replace_file(folder.path() / "one", "earlier");
  {
    Replacements written;
    written.add(folder.path() / "one", "new");
  }

  EXPECT_EQ(test::content_of(folder.path() / "one"), "earlier");
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(Replacements, NameFileAndReasonIfItCannotBeWritten) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "missing/one";

  EXPECT_EQ(test::error_of([&] { replace_file(file, "new"); }),
            file.string() + ": cannot be written: No such file or directory");
}

TEST(Replacements, LeaveNothingBehindIfAFileCannotBeReplaced) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder.path() / "one/inside");

  EXPECT_THROW(replace_file(folder.path() / "one", "new"), Error);

  EXPECT_EQ(files_in(folder.path()), 1);
}

}  // namespace
}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
//
// A process that dies at any write to its recording leaves a recording that opens, or none.
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>
#include <hdf5.h>

#include <rths/recording/recording.hpp>

#include "recording/sample_recording.hpp"
#include "support/files.hpp"

namespace {

int writes_to_live = -1;  // negative: for ever

// A kernel can cut a write of several pages when the process is killed.
std::size_t length_before_death(std::size_t length) {
  constexpr std::size_t kPage = 4096;
  if (writes_to_live < 0 || writes_to_live-- > 0) return length;
  return length > kPage ? kPage : 0;
}

}  // namespace

// The HDF5 library writes with these functions; it finds them here before the C library's.
extern "C" ssize_t pwrite(int file, const void* data, std::size_t length, off_t at) {
  const std::size_t written = length_before_death(length);
  const ssize_t result = syscall(SYS_pwrite64, file, data, written, at);
  if (written < length) std::raise(SIGKILL);
  return result;
}
extern "C" int ftruncate(int file, off_t length) noexcept {
  if (length_before_death(1) == 0) std::raise(SIGKILL);
  return static_cast<int>(syscall(SYS_ftruncate, file, length));
}

namespace rths::recording {
namespace {

constexpr int kRows = 250;

// The life of a recording: creation, three batches, end, additions of the launcher.
void record(const std::filesystem::path& file) {
  {
    Writer writer = open_writer(file);
    write_rows(writer, 0, kRows);
    writer.close();
  }
  add_meta(file, {{"processes", "5"}, {"privileges", std::string(300, 'p')}});
  add_meta(file, {}, {{"host_late", {0.01, std::vector<double>(1000, 0.5)}}});
}

// @returns true if the process died at its write number `writes`
bool dies_after(int writes, const std::filesystem::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    writes_to_live = writes;
    const std::string error = test::error_of([&] { record(file); });
    _exit(error.empty() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << "after write " << writes;
  return WIFSIGNALED(status);
}

bool opens_in_every_program(const std::filesystem::path& file) {
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (opened >= 0) H5Fclose(opened);
  return opened >= 0;
}

// Opens after the repair, with all rows up to the last batch and all that was added completely.
void expect_readable(const std::filesystem::path& file) {
  static_cast<void>(repair(file));
  EXPECT_TRUE(opens_in_every_program(file));
  const Reader reader{file};
  expect_rows(reader, reader.rows());
  EXPECT_EQ(reader.meta().at("host"), "here");
  EXPECT_EQ(reader.drops().size(), 1U);
  EXPECT_EQ(reader.config("lab.toml"), "name = \"lab\"\n");
  EXPECT_LE(reader.events().size(), 1U);
  static_cast<void>(reader.meta_series("host_late"));
}

TEST(Crash, AtAnyWriteLeavesARecordingThatOpensOrNone) {
  constexpr int kMostWrites = 1000;
  int absent = 0, opened = 0;
  std::string broken;
  bool died = true;
  while (died && absent + opened < kMostWrites) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "run.h5";
    died = dies_after(absent + opened, file);
    if (!std::filesystem::exists(file)) {
      ++absent;
      continue;
    }
    const std::string error = test::error_of([&] { expect_readable(file); });
    if (!error.empty()) broken += std::to_string(absent + opened) + ": " + error + "\n";
    ++opened;
  }

  EXPECT_FALSE(died);
  EXPECT_EQ(broken, "");
  EXPECT_GT(absent, 5);
  EXPECT_GT(opened, 50);
}

}  // namespace
}  // namespace rths::recording

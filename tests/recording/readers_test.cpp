// SPDX-License-Identifier: Apache-2.0
//
// Programs that have a recording open or locked, and file systems without locks.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include <gtest/gtest.h>
#include <hdf5.h>

#include <rths/recording/recording.hpp>

#include "recording/sample_recording.hpp"
#include "support/files.hpp"

namespace {

bool has_locks = true;

}  // namespace

// The HDF5 library locks with this function; it finds it here before the C library's.
extern "C" int flock(int file, int operation) noexcept {
  if (has_locks) return static_cast<int>(syscall(SYS_flock, file, operation));
  errno = ENOLCK;
  return -1;
}

namespace rths::recording {
namespace {

constexpr int kRowsOfRun = 250;

class OpenReaders : public ::testing::Test {
 protected:
  void SetUp() override {
    Writer writer = open_writer(file_);
    write_rows(writer, 0, kRowsOfRun);
    writer.close();
  }
  void TearDown() override { has_locks = true; }
  void end_run() {
    add_meta(file_, {{"ending", "completed"}}, {{"host_late", {0.01, {0.5, 0.25}}}});
    compress(file_);
  }
  void expect_complete() {
    const Reader reader{file_};
    expect_rows(reader, kRowsOfRun);
    EXPECT_EQ(reader.meta().at("ending"), "completed");
    EXPECT_EQ(reader.meta_series("host_late").values, (std::vector<double>{0.5, 0.25}));
    EXPECT_FALSE(std::filesystem::exists(file_.string() + kCopying));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "run.h5";
};

TEST_F(OpenReaders, WithALockDoNotStopTheEndOfARun) {
  for (const int lock : {LOCK_SH, LOCK_EX}) {
    SetUp();
    const int reader = open(file_.c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(flock(reader, lock | LOCK_NB), 0);

    EXPECT_EQ(test::error_of([&] { end_run(); }), "");

    expect_complete();
    close(reader);
  }
}

TEST_F(OpenReaders, OfTheLibraryKeepTheRowsThatTheyHave) {
  const hid_t plain = H5Fopen(file_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(plain, 0);
  const Reader ours{file_};

  EXPECT_EQ(test::error_of([&] { end_run(); }), "");

  expect_complete();
  expect_rows(ours, kRowsOfRun);
  EXPECT_EQ(ours.meta().count("ending"), 0U);
  EXPECT_GE(H5Fclose(plain), 0);
}

TEST_F(OpenReaders, DoNotStopTheRepairOfARecordingWhoseWriterWasKilled) {
  const pid_t child = fork();
  if (child == 0) {
    Writer writer = open_writer(file_);
    write_rows(writer, 0, kRowsOfRun);
    _exit(0);  // without closing it
  }
  waitpid(child, nullptr, 0);
  const int reader = open(file_.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(reader, LOCK_SH | LOCK_NB), 0);

  add_meta(file_, {{"ending", "the recorder was killed"}});

  const hid_t plain = H5Fopen(file_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(plain, 0);
  H5Fclose(plain);
  EXPECT_EQ(Reader{file_}.meta().at("ending"), "the recorder was killed");
  close(reader);
}

TEST_F(OpenReaders, MayHaveAFileSystemWithoutLocks) {
  has_locks = false;
  SetUp();

  EXPECT_EQ(test::error_of([&] { end_run(); }), "");

  expect_complete();
}

TEST_F(OpenReaders, SeeAnAdditionInPlaceIfNoCopyCanBeMade) {
  std::filesystem::create_directories(file_.string() + kCopying + "/in_the_way");

  add_meta(file_, {{"ending", "completed"}});

  EXPECT_EQ(Reader{file_}.meta().at("ending"), "completed");
}

}  // namespace
}  // namespace rths::recording

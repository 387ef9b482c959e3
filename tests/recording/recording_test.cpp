// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/table.hpp>

#include "recording/sample_recording.hpp"
#include "recording/src/probe.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"

namespace rths::recording {
namespace {

TEST(Recording, ReturnsEveryWrittenValue) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  write_rows(writer, 0, 1234);
  writer.close();

  expect_rows(Reader{file}, 1234);
}

TEST(Recording, CarriesNamesUnitsMapConfigurationAndMeta) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  write_rows(writer, 0, 10);
  writer.close();

  const Reader reader{file};

  EXPECT_EQ(reader.names(),
            (std::vector<std::string>{"fbk.long.displ", "fbk.lat.displ",
                                      "monitor.machine.host.step", "monitor.machine.host.status"}));
  EXPECT_EQ(reader.unit("fbk.long.displ"), "m");
  EXPECT_EQ(reader.map().hash(), sample_map().hash());
  EXPECT_EQ(reader.config("lab.toml"), "name = \"lab\"\n");
  EXPECT_EQ(reader.config("empty"), "");
  EXPECT_EQ(reader.config("not there"), "");
  EXPECT_EQ(reader.meta().at("host"), "here");
}

TEST(Recording, HasAnEventForEachChangeOfAnEventSignal) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  write_rows(writer, 0, 50);
  writer.close();

  const auto events = Reader{file}.events();

  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events[0].time, 0.030, 1e-12);
  EXPECT_EQ(events[0].signal, "monitor.machine.host.status");
  EXPECT_EQ(events[0].value, 1);
}

TEST(Recording, CountsTheStepsWithoutARow) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  for (const int i : {0, 1, 2, 5, 5, 6, 9}) writer.append(time_of(i), row(i));
  writer.close();

  const auto drops = Reader{file}.drops();

  ASSERT_EQ(drops.size(), 1U);
  EXPECT_EQ(drops[0].first, "machine");
  EXPECT_EQ(drops[0].second, 4);  // steps 4, 5 and 8, 9 of the node, counted from 1
}

// A row holds at most one step of a slow node, and one or two of a node that is slightly faster.
TEST(Recording, CountsNoStepWithoutARowOfNodesSlowerOrSlightlyFasterThanTheRows) {
  const test::TemporaryFolder folder;
  for (const double period_ms : {0.7, 1.5, 2.0, 3.0, 7.0, 100.0}) {
    const auto file = folder.path() / "run.h5";
    Writer writer = open_writer(file, 1 / period_ms);
    for (int i = 0; i < 2000; ++i) {
      auto values = row(i);
      values[2] = 1 + std::floor((i + 0.5) / period_ms);
      writer.append(time_of(i), values);
    }
    writer.close();
    EXPECT_EQ(Reader{file}.drops()[0].second, 0) << period_ms;
  }
}

// Of a node with four steps per row, a late row has a few more and the next one fewer.
TEST(Recording, CountsOnlyTheStepsOfMissingRows) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file, 4);
  int step = 1;
  for (const int steps : {0, 4, 5, 3, 4, 7, 1, 4, 8, 4, 13, 4}) {
    auto values = row(step);
    values[2] = step += steps;
    writer.append(time_of(step), values);
  }
  writer.close();

  EXPECT_EQ(Reader{file}.drops()[0].second, 4 + 8);  // of one row and of two
}

TEST(Recording, CanBeReadWhileItGrows) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  write_rows(writer, 0, 250);

  expect_rows(Reader{file}, 200);  // whole batches of a hundred
  write_rows(writer, 250, 300);
  expect_rows(Reader{file}, 300);
}

TEST(Recording, SuggestsTheNearestSignal) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  open_writer(file).close();

  EXPECT_EQ(test::error_of([&] { static_cast<void>(Reader{file}.signal("fbk.long.dspl")); }),
            "the recording has no signal 'fbk.long.dspl' (did you mean 'fbk.long.displ'?)");
}

TEST(Recording, RefusesOtherFiles) {
  const test::TemporaryFolder folder;
  const auto text = folder.write("a.h5", "no HDF5 at all");

  EXPECT_FALSE(is_hdf5(text));
  EXPECT_NE(test::error_of([&] { Reader{text}; }), "");
  EXPECT_NE(test::error_of([&] { Reader{folder.path() / "none.h5"}; }), "");
}

TEST(Recording, TakesMetaAndSeriesAfterItIsClosed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  Writer writer = open_writer(file);
  write_rows(writer, 0, 10);
  writer.close();

  add_meta(file, {{"processes", "5"}});
  add_meta(file, {}, {{"host_late", {0.01, {0.5, 0.25}}}});

  const Reader reader{file};
  EXPECT_EQ(reader.meta().at("processes"), "5");
  EXPECT_EQ(reader.meta_series("host_late").interval, 0.01);
  EXPECT_EQ(reader.meta_series("host_late").values, (std::vector<double>{0.5, 0.25}));
  EXPECT_TRUE(reader.meta_series("nothing").values.empty());
}

TEST(Recording, NeedsNoRepairAfterItIsClosed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  open_writer(file).close();

  EXPECT_FALSE(repair(file));
}

// After a kill at a random moment, a recording holds every row up to the last flush with correct
// values. It can be read unrepaired; after the repair every HDF5 program opens it.
TEST(Recording, SurvivesKillAtAnyMoment) {
  std::mt19937 random{17};
  std::uniform_int_distribution<int> microseconds{0, 50'000};
  const int trials = test::is_long() ? 200 : 20;
  for (int trial = 0; trial < trials; ++trial) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "run.h5";
    std::array<int, 2> begun{};
    ASSERT_EQ(pipe(begun.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
      Writer writer = open_writer(file);
      static_cast<void>(!write(begun[1], "b", 1));
      for (int i = 0;; ++i) writer.append(time_of(i), row(i));
    }
    char byte = 0;
    ASSERT_EQ(read(begun[0], &byte, 1), 1);  // before this, the file has no rows
    close(begun[0]);
    close(begun[1]);
    usleep(static_cast<useconds_t>(microseconds(random)));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);

    const std::size_t rows = Reader{file}.rows();
    expect_rows(Reader{file}, rows);
    EXPECT_TRUE(repair(file)) << trial;
    EXPECT_FALSE(repair(file)) << trial;
    expect_rows(Reader{file}, rows);
  }
}

TEST(Recording, ReportsAFullFileSystem) {
  const test::TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    static_cast<void>(!std::freopen((folder.path() / "output").c_str(), "w", stderr));
    std::string error;
    // As in the recorder: another thread than the one that opened the file.
    Writer writer = open_writer(folder.path() / "run.h5");
    std::thread{[&] {
      error = test::error_of([&] {
        write_rows(writer, 0, 100'000);
        writer.close();
      });
    }}.join();
    _exit(error.find("is the disk full?") != std::string::npos ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);

  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(test::content_of(folder.path() / "output"), "");

  // Written values are correct; the others are NaN.
  EXPECT_FALSE(repair(folder.path() / "run.h5"));
  const Reader reader{folder.path() / "run.h5"};
  const auto along = reader.signal("fbk.long.displ");
  ASSERT_GT(along.size(), 1000U);
  for (std::size_t i = 0; i < along.size(); ++i)
    ASSERT_TRUE(along[i] == row(static_cast<int>(i))[0] || std::isnan(along[i])) << i;
}

TEST(Recording, FailsIfItsFileIsRemovedOrReplaced) {
  for (const bool replaced : {false, true}) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "run.h5";
    Writer writer = open_writer(file);
    write_rows(writer, 0, 100);
    std::filesystem::remove(file);
    if (replaced) folder.write("run.h5", "another file");

    EXPECT_EQ(test::error_of([&] { write_rows(writer, 100, 200); }),
              file.string() + ": was removed or replaced while it was written");
  }
}

// Some of these crash the HDF5 library, or let it loop or allocate without limit.
TEST(Recording, WithDamageIsAnErrorOrReadable) {
  const test::TemporaryFolder folder;
  {
    Writer writer = open_writer(folder.path() / "run.h5");
    write_rows(writer, 0, 300);
    writer.close();
  }
  const std::string good = test::content_of(folder.path() / "run.h5");
  const std::uint64_t trials = test::is_long() ? 2000 : 20;
  int refused = 0;
  for (std::uint64_t seed = 0; seed < trials; ++seed) {
    std::mt19937_64 random{seed};
    std::string bytes = good;
    for (int i = 0; i < 200; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    const std::string name = std::to_string(seed) + ".h5";
    const auto file =
        folder.write(name, bytes.substr(0, bytes.size() - seed % 2 * (random() % 500)));
    const auto begun = std::chrono::steady_clock::now();
    for (const auto& read : {std::function<void()>{[&] { static_cast<void>(repair(file)); }},
                             std::function<void()>{[&] {
                               const Reader reader{file};
                               for (const auto& signal : reader.names())
                                 static_cast<void>(reader.signal(signal));
                               static_cast<void>(reader.events());
                             }},
                             std::function<void()>{[&] { static_cast<void>(Table::load(file)); }}})
      refused += test::error_of(read).empty() ? 0 : 1;
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds{60}) << seed;
    std::filesystem::remove(file);
  }
  EXPECT_GT(refused, 0);
}

// The child that reads a file first ends with it.
TEST(Recording, IsRefusedIfReadingItCrashes) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("file", "content");

  EXPECT_EQ(test::error_of([&] { probe(file, [] { std::raise(SIGSEGV); }); }),
            file.string() + ": is damaged: reading it crashed, or took too much time or memory");
  EXPECT_EQ(test::error_of([&] { probe(file, [] {}); }), "");
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(in_child(file, []() -> bool { throw Error{"of the child"}; }));
            }),
            "of the child");
  EXPECT_TRUE(in_child(file, [] { return true; }));
  EXPECT_FALSE(in_child(file, [] { return false; }));
}

// Only a recording left by a crash is repaired, not one with a live writer.
TEST(Recording, IsNotRepairedWhileItIsWritten) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  const pid_t child = fork();
  if (child == 0) {
    Writer writer = open_writer(file);
    write_rows(writer, 0, 1000);
    static_cast<void>(folder.write("written", ""));
    pause();
  }
  for (int i = 0; i < 5000 && !std::filesystem::exists(folder.path() / "written"); ++i)
    usleep(1000);

  EXPECT_FALSE(repair(file));
  expect_rows(Reader{file}, 1000);

  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(repair(file));
  expect_rows(Reader{file}, 1000);
}

void write_recording(const std::filesystem::path& file) {
  Writer writer = open_writer(file);
  write_rows(writer, 0, 10'000);
  writer.close();
  add_meta(file, {}, {{"host_late", {0.01, {0.5, 0.25}}}});
}

TEST(Recording, HasTheSameContentAfterItIsCompressed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  write_recording(file);
  const auto bytes = std::filesystem::file_size(file);
  const Reader before{file};

  compress(file);

  EXPECT_LT(std::filesystem::file_size(file), bytes / 4);
  EXPECT_FALSE(repair(file));
  const Reader after{file};
  expect_rows(after, 10'000);
  EXPECT_EQ(after.names(), before.names());
  EXPECT_EQ(after.unit("fbk.long.displ"), "m");
  EXPECT_EQ(after.map().hash(), before.map().hash());
  EXPECT_EQ(after.config("lab.toml"), "name = \"lab\"\n");
  EXPECT_EQ(after.meta(), before.meta());
  EXPECT_EQ(after.meta_series("host_late").interval, 0.01);
  EXPECT_EQ(after.meta_series("host_late").values, (std::vector<double>{0.5, 0.25}));
  ASSERT_EQ(after.events().size(), 1U);
  EXPECT_EQ(after.events()[0].signal, "monitor.machine.host.status");
  EXPECT_EQ(after.drops(), before.drops());
}

TEST(Recording, TakesMetaAfterItIsCompressed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  write_recording(file);
  compress(file);

  add_meta(file, {{"added", "later"}});

  EXPECT_EQ(Reader{file}.meta().at("added"), "later");
}

TEST(Recording, IsCompressedToTheSameBytesEveryTime) {
  const test::TemporaryFolder folder;
  const auto first = folder.path() / "first.h5", second = folder.path() / "second.h5";
  write_recording(first);
  compress(first);
  usleep(1'100'000);  // times of the clock in the file would differ
  write_recording(second);
  compress(second);

  EXPECT_EQ(test::content_of(first), test::content_of(second));
}

TEST(Recording, StaysAsItIsIfItCannotBeCompressed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  write_recording(file);
  const std::string content = test::content_of(file);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20'000, 20'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string error = test::error_of([&] { compress(file); });
    // The library can report the full disk when it writes a dataset, or at the end.
    _exit(error.ends_with("(is the disk full?) failed (it stays uncompressed)") ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);

  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(test::content_of(file), content);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1);
}

TEST(AtEachCount, TakesTheFirstValueOfEachCount) {
  EXPECT_EQ(at_each_count({0, 1, 1, 2, 3}, {9, 10, 11, 20, 30}), (std::vector<double>{10, 20, 30}));
}

TEST(AtEachCount, InterpolatesMissingCounts) {
  EXPECT_EQ(at_each_count({1, 4}, {10, 40}), (std::vector<double>{10, 20, 30, 40}));
}

TEST(AtEachCount, RepeatsTheFirstCountBackwards) {
  EXPECT_EQ(at_each_count({3, 4}, {30, 40}), (std::vector<double>{30, 30, 30, 40}));
}

TEST(AtEachCount, IsEmptyWithoutCounts) { EXPECT_TRUE(at_each_count({0, 0}, {1, 2}).empty()); }

}  // namespace
}  // namespace rths::recording

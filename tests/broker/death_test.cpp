// SPDX-License-Identifier: Apache-2.0
//
// A writer dies, or stops, between any two of its instructions. Readers continue, no group is read
// torn, no complete write is lost, and a successor finds a consistent ring.
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>

#include "broker/src/record.hpp"
#include "broker/src/segment.hpp"
#include "support/long_run.hpp"
#include "support/realtime_guard.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using std::chrono::steady_clock;
using test::RingRemoval;
using test::small_map;
using test::unique_ring;

/// A latch, a line, and records of several lines.
constexpr std::uint32_t kGroupLengths[] = {5, 15, 100};
constexpr LongwordOffset kLooseWord{500};
constexpr TearGroupId kGroup{0};

/// The value of a group whose words are all equal; empty if they differ.
std::optional<std::uint32_t> whole_value(const Node& reader, std::uint32_t length) {
  std::vector<std::uint32_t> words(length);
  if (reader.read_group(kGroup, words) != Status::Ok) return std::nullopt;
  const bool alike = std::all_of(words.begin(), words.end(), [&](auto w) { return w == words[0]; });
  return alike ? std::optional{words[0]} : std::nullopt;
}

void mark_as_dead(Segment& segment, NodeId node) {
  for (Slot& slot : segment.slots())
    if (slot.node == node.value()) slot.claim = 1ULL << 40 | 999'999'999;  // no process
}

/// A copy of the ring in which the writer is marked as dead: the state after its death.
class Aftermath {
 public:
  Aftermath(const std::string& ring, const std::string& copy) : removal_{copy} {
    copy_object("/dev/shm/" + object_name(ring), "/dev/shm/" + object_name(copy));
    segment_ = Segment::attach_shared(copy);
    mark_as_dead(*segment_, NodeId{1});
    ring_.emplace(Ring::attach(copy));
  }
  [[nodiscard]] Ring& ring() { return *ring_; }
  /// True if all words of the group's record and memory have this value.
  [[nodiscard]] bool is_repaired(std::uint32_t value) {
    const GroupView& group = segment_->groups()[0];
    std::vector<std::uint32_t> words(group.longwords);
    if (!read_record(group.record, words)) return false;
    const auto* memory = segment_->words() + group.base;
    return std::all_of(words.begin(), words.end(), [&](auto w) { return w == value; }) &&
           std::all_of(memory, memory + group.longwords, [&](auto w) { return w == value; });
  }

 private:
  // Copies all but the cards, which are large and not needed here.
  static void copy_object(const std::string& from, const std::string& to) {
    std::ifstream source{from, std::ios::binary};
    Header header{};
    source.read(reinterpret_cast<char*>(&header), sizeof header);
    std::vector<char> bytes(header.cards_at);
    source.seekg(0).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    std::ofstream{to, std::ios::binary}.write(bytes.data(),
                                              static_cast<std::streamsize>(bytes.size()));
    std::filesystem::resize_file(to, total_bytes(header));
  }

  RingRemoval removal_;
  std::unique_ptr<Segment> segment_;
  std::optional<Ring> ring_;
};

// The kernel's clock repeats its reading if it took too long, so a look inside would never end.
bool reads_the_clock(pid_t child) {
  constexpr std::uint64_t kLongest = 16384;
  user_regs_struct registers{};
  ptrace(PTRACE_GETREGS, child, nullptr, &registers);
  return registers.rip - getauxval(AT_SYSINFO_EHDR) < kLongest;
}

class DeathOf : public ::testing::TestWithParam<std::uint32_t> {};

/// Writes ones, stops, writes twos, stops.
void write_twice_and_stop(const std::string& ring_name, std::uint32_t length) {
  Ring ring = Ring::attach(ring_name);
  Node machine = ring.join("machine", 0);
  const std::vector<std::uint32_t> ones(length, 1);
  const std::vector<std::uint32_t> twos(length, 2);
  static_cast<void>(machine.write_group(kGroup, ones));
  static_cast<void>(machine.write(kLooseWord, 1));
  raise(SIGSTOP);
  static_cast<void>(machine.write_group(kGroup, twos));
  static_cast<void>(machine.write(kLooseWord, 2));
  machine.beat();
  raise(SIGSTOP);
  _exit(0);
}

// Steps through a write instruction by instruction. The memory after each one is the state that a
// process leaves if it is stopped or killed there.
TEST_P(DeathOf, AWriterLeavesNothingTornAtAnyInstruction) {
  const std::uint32_t length = GetParam();
  const std::string name = unique_ring("step_" + std::to_string(length));
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map(length), 6);
  const Node reader = ring.observe();
  Follower follower = ring.follow("machine");
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(77);
    write_twice_and_stop(name, length);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) GTEST_SKIP() << "SKIPPED: this host does not allow single steps";
  ASSERT_EQ(whole_value(reader, length), 1U);

  // Sanitizers execute many instructions for one.
  const int look_after_every = test::RealTimeGuard::supported() ? 3 : 61;
  int steps = 0;
  std::uint32_t seen = 1;
  for (;; ++steps) {
    ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr);
    waitpid(child, &status, 0);
    if (!WIFSTOPPED(status) || WSTOPSIG(status) != SIGTRAP) break;
    const auto now = whole_value(reader, length);
    ASSERT_TRUE(now.has_value()) << "torn after instruction " << steps;
    ASSERT_GE(*now, seen) << "an older value after instruction " << steps;
    seen = *now;
    if (steps % look_after_every != 0 || reads_the_clock(child)) continue;
    Aftermath aftermath{name, name + "_copy"};
    Node successor = aftermath.ring().join("machine", 0);
    const auto after = whole_value(successor, length);
    ASSERT_TRUE(after.has_value()) << "torn for a successor after instruction " << steps;
    ASSERT_GE(*after, seen) << "lost for a successor after instruction " << steps;
    ASSERT_TRUE(aftermath.is_repaired(*after)) << "not repaired after instruction " << steps;
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);

  EXPECT_EQ(seen, 2U);
  EXPECT_GT(steps, 50);
  Write write;
  std::vector<std::uint32_t> followed;
  while (follower.next(write) == Followed::Write)
    if (!write.group.empty()) followed.push_back(write.group.back());
  EXPECT_EQ(followed, (std::vector<std::uint32_t>{1, 2}));
}

INSTANTIATE_TEST_SUITE_P(Words, DeathOf, ::testing::ValuesIn(kGroupLengths));

/// A shared ring, and its bytes, after a writer died.
class DeadWriter : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kWords = 100;
  std::string name = unique_ring("dead_writer");
  RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map(kWords), 6);
  std::unique_ptr<Segment> segment = Segment::attach_shared(name);
  JournalView journal = segment->journal(0);
  std::vector<std::uint32_t> ones = std::vector<std::uint32_t>(kWords, 1);
  std::vector<std::uint32_t> twos = std::vector<std::uint32_t>(kWords, 2);

  void live_and_write_ones() {
    Node machine = ring.join("machine", 0);
    ASSERT_EQ(machine.write_group(kGroup, ones), Status::Ok);
  }
  std::uint32_t* record() { return segment->groups()[0].record; }
  void die_in_the_record_of_twos() {
    record()[0] = (record()[0] & ~kDisabled) | 1U;
    store_words(record() + kLineBytes / 4, {twos.data(), kWords / 2});
  }
  void die_in_the_memory_of_twos() {
    write_record(record(), twos, count_of(record()));
    store_words(segment->words(), {twos.data(), kWords / 2});
  }
};

TEST_F(DeadWriter, LeavesMemoryToReadersAndSuccessorIfTheRecordIsTorn) {
  live_and_write_ones();
  die_in_the_record_of_twos();

  EXPECT_EQ(whole_value(ring.observe(), kWords), 1U);
  const Node successor = ring.join("machine", 0);
  EXPECT_EQ(whole_value(successor, kWords), 1U);
  EXPECT_FALSE(is_torn(record(), kWords));
}

TEST_F(DeadWriter, LeavesTheInitialMemoryIfItsFirstWriteIsTorn) {
  store_words(segment->words(), ones);
  die_in_the_record_of_twos();

  EXPECT_EQ(whole_value(ring.observe(), kWords), 1U);
  EXPECT_EQ(whole_value(ring.join("machine", 0), kWords), 1U);
}

TEST_F(DeadWriter, LeavesARecordThatCompletesMemory) {
  live_and_write_ones();
  die_in_the_memory_of_twos();

  EXPECT_EQ(whole_value(ring.observe(), kWords), 2U);
  const Node successor = ring.join("machine", 0);
  EXPECT_EQ(whole_value(successor, kWords), 2U);
  EXPECT_EQ(successor.read(LongwordOffset{kWords - 1}), 2U);
}

TEST_F(DeadWriter, RepeatsNoWriteForFollowersIfTheNextOneWasTorn) {
  live_and_write_ones();
  Follower follower = ring.follow("machine");
  die_in_the_record_of_twos();
  const Node successor = ring.join("machine", 0);
  Write write;

  EXPECT_EQ(follower.next(write), Followed::Nothing);
}

TEST_F(DeadWriter, RepeatsNoWriteForFollowersIfItWasJournalledButNotMarked) {
  live_and_write_ones();
  Follower follower = ring.follow("machine");
  write_record(record(), twos, count_of(record()));
  JournalWriter{journal}.group(0, twos, count_of(record()));
  const Node successor = ring.join("machine", 0);
  Write write;

  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(follower.next(write), Followed::Nothing);
}

TEST_F(DeadWriter, DoesNotLeaveAStaleCacheInAReader) {
  live_and_write_ones();
  const Node reader = ring.observe();
  ASSERT_EQ(whole_value(reader, kWords), 1U);
  die_in_the_memory_of_twos();
  EXPECT_EQ(whole_value(reader, kWords), 2U);
  ASSERT_EQ(ring.join("machine", 0).write_group(kGroup, ones), Status::Ok);

  EXPECT_EQ(whole_value(reader, kWords), 1U);
}

TEST_F(DeadWriter, DoesNotHideAPlainClientsStoresFromAReader) {
  live_and_write_ones();
  const Node reader = ring.observe();
  ASSERT_EQ(whole_value(reader, kWords), 1U);
  {
    const Node plain = ring.join_plain("machine");
    store_words(segment->words(), twos);
    EXPECT_EQ(whole_value(reader, kWords), 2U);
  }
  live_and_write_ones();

  EXPECT_EQ(whole_value(reader, kWords), 1U);
}

TEST_F(DeadWriter, DeliversToFollowersTheWriteThatReadersSaw) {
  live_and_write_ones();
  Follower follower = ring.follow("machine");
  die_in_the_memory_of_twos();
  const Node successor = ring.join("machine", 0);
  Write write;

  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(std::vector(write.group.begin(), write.group.end()), twos);
  EXPECT_EQ(follower.next(write), Followed::Nothing);
}

TEST_F(DeadWriter, DoesNotBlockFollowersByAnIncompleteGroup) {
  Follower follower = ring.follow("machine");
  const std::uint32_t lap = journal.lap(0) << 4U;
  publish(journal.slot(0), 0, kWords, 0, lap | static_cast<std::uint32_t>(EntryKind::Group));
  publish(journal.slot(1), 1, 1, 1, lap | static_cast<std::uint32_t>(EntryKind::Data));
  Node successor = ring.join("machine", 0);
  ASSERT_EQ(successor.write(kLooseWord, 7), Status::Ok);
  Write write;

  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.value, 7U);
}

/// Writes that a writer has begun and completed, reported outside the ring.
struct Progress {
  std::atomic<std::uint32_t> begun{0}, completed{0};
};

Progress& shared_progress() {
  void* page = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return *new (page) Progress;
}

void write_forever(const std::string& ring_name, std::uint32_t length, Progress& progress) {
  Ring ring = Ring::attach(ring_name);
  Node machine = ring.join("machine", 0);
  std::vector<std::uint32_t> words(length);
  for (std::uint32_t count = progress.completed + 1;; ++count) {
    std::fill(words.begin(), words.end(), count);
    progress.begun.store(count);
    static_cast<void>(machine.write_group(kGroup, words));
    progress.completed.store(count);
    static_cast<void>(machine.write(kLooseWord, count));
  }
}

struct Tally {
  int kills = 0, stops = 0;
  long reads = 0, torn = 0, hung = 0, lost = 0;
  std::vector<double> repair;  ///< from the kill until a successor reads the last whole write [s]
};

/// Runs one writer, kills it at a random moment, in some cases after a stop; then runs its
/// successor.
void kill_one(const std::string& name, std::uint32_t length, Progress& progress,
              std::mt19937& random, const Node& reader, Tally& tally) {
  const pid_t child = fork();
  if (child == 0) write_forever(name, length, progress);
  const std::uint32_t before = progress.completed;
  const auto check = [&] {
    ++tally.reads;
    const auto begun = steady_clock::now();
    const std::uint32_t completed = progress.completed;
    const auto value = whole_value(reader, length);
    tally.torn += value ? 0 : 1;
    tally.lost += value && *value < completed ? 1 : 0;
    tally.hung += steady_clock::now() - begun > std::chrono::milliseconds{100} ? 1 : 0;
  };
  while (progress.completed == before) std::this_thread::yield();
  const auto until = steady_clock::now() + std::chrono::microseconds{random() % 300};
  do check();
  while (steady_clock::now() < until);
  if (random() % 3 == 0) {
    ++tally.stops;
    kill(child, SIGSTOP);
    waitpid(child, nullptr, WUNTRACED);
    for (int i = 0; i < 20; ++i) check();
  }
  kill(child, SIGKILL);
  const auto killed = steady_clock::now();
  ++tally.kills;
  waitpid(child, nullptr, 0);
  check();
  Ring ring = Ring::attach(name);
  const Node successor = ring.join("machine", 0);
  const auto value = whole_value(successor, length);
  tally.torn += value ? 0 : 1;
  tally.lost += value && *value < progress.completed ? 1 : 0;
  tally.repair.push_back(std::chrono::duration<double>(steady_clock::now() - killed).count());
}

class KillsOf : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(KillsOf, AWriterCauseNoTornLostOrHangingRead) {
  const std::uint32_t length = GetParam();
  const std::string name = unique_ring("kills_" + std::to_string(length));
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map(length));
  const Node reader = ring.observe();
  Progress& progress = shared_progress();
  constexpr unsigned kSeed = 4;
  std::mt19937 random{kSeed};
  Tally tally;
  const int kills = test::is_long() ? 3400 : 100;

  while (tally.kills < kills) kill_one(name, length, progress, random, reader, tally);

  std::sort(tally.repair.begin(), tally.repair.end());
  const double p99 = tally.repair[static_cast<std::size_t>(0.99 * (kills - 1))];
  RecordProperty("kills", tally.kills);
  RecordProperty("stopped", tally.stops);
  RecordProperty("reads", std::to_string(tally.reads));
  RecordProperty("torn", std::to_string(tally.torn));
  RecordProperty("hung", std::to_string(tally.hung));
  RecordProperty("lost", std::to_string(tally.lost));
  RecordProperty("repair_p99_ms", std::to_string(1e3 * p99));
  std::printf(
      "seed %u, %d kills (%d stopped before), %ld reads, torn %ld, hung %ld, lost %ld, "
      "repair p99 %.2f ms\n",
      kSeed, tally.kills, tally.stops, tally.reads, tally.torn, tally.hung, tally.lost, 1e3 * p99);
  EXPECT_EQ(tally.torn, 0);
  EXPECT_EQ(tally.hung, 0);
  EXPECT_EQ(tally.lost, 0);
  if (test::RealTimeGuard::supported()) {
    EXPECT_LE(p99, 0.050);  // not with sanitizers, which start processes slowly
  }
}

INSTANTIATE_TEST_SUITE_P(Words, KillsOf, ::testing::ValuesIn(kGroupLengths));

}  // namespace
}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
//
// Journals without a ring, and short, so that they wrap after few entries.
#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "broker/src/journal.hpp"
#include "support/realtime_guard.hpp"

namespace rths::broker {
namespace {

constexpr std::uint32_t kBits = 6;
constexpr std::uint64_t kLength = 1U << kBits;

/// A journal in plain memory.
struct Journal {
  alignas(128) JournalHead head{};
  std::array<JournalEntry, kLength> entries{};
  JournalView view{&head, entries.data(), kBits};
};

std::uint32_t word_at(const JournalView& view, std::uint64_t position) {
  JournalEntry entry;
  return fetch_at(view, position, entry) == Fetched::Entry ? entry.b : ~0U;
}

TEST(Journal, ReadsEntriesUntilTheyAreOverwritten) {
  Journal journal;
  JournalWriter writer{journal.view};
  for (std::uint32_t i = 0; i < 1000; ++i) writer.word(i, 7 * i);

  JournalEntry entry;
  for (std::uint64_t i = 1000 - kLength; i < 1000; ++i) EXPECT_EQ(word_at(journal.view, i), 7 * i);
  EXPECT_EQ(fetch_at(journal.view, 1000 - kLength - 1, entry), Fetched::Gone);
  EXPECT_EQ(fetch_at(journal.view, 1000, entry), Fetched::NotYet);
  EXPECT_EQ(end_of(journal.view), 1000U);
  EXPECT_EQ(begin_of(journal.view), 1000 - kLength);
}

TEST(Journal, IsEmptyBeforeTheFirstWrite) {
  Journal journal;
  JournalEntry entry;

  EXPECT_EQ(end_of(journal.view), 0U);
  EXPECT_EQ(fetch_at(journal.view, 0, entry), Fetched::NotYet);
}

// The predecessor may have ended at any position, with or without a hint.
TEST(Journal, ContinuesAtTheEndOfAPredecessor) {
  for (std::uint32_t first = 0; first < 3 * kLength; ++first) {
    Journal journal;
    JournalWriter predecessor{journal.view};
    for (std::uint32_t i = 0; i < first; ++i) predecessor.word(0, i);

    JournalWriter successor{journal.view};
    successor.word(0, 12345);

    EXPECT_EQ(word_at(journal.view, first), 12345U) << first;
  }
}

TEST(Journal, HoldsGroupsOfAnyLength) {
  for (std::uint32_t length = 1; length <= 100; ++length) {
    Journal journal;
    JournalWriter writer{journal.view};
    std::vector<std::uint32_t> words(length);
    for (std::uint32_t i = 0; i < length; ++i) words[i] = 1000 + i;
    writer.word(1, 1);
    const std::uint64_t position = end_of(journal.view);
    writer.group(40, words, 0);
    std::vector<std::uint32_t> read(length);

    EXPECT_TRUE(read_journalled_group(journal.view, position, 40, read));
    EXPECT_EQ(read, words);
    EXPECT_FALSE(read_journalled_group(journal.view, position, 41, read));
    EXPECT_FALSE(read_journalled_group(journal.view, position + 1, 40, read));
  }
}

// The lap number has 28 bits; when it wraps, the next lap is still ahead.
TEST(Journal, DistinguishesAheadFromBehindWhenLapsWrap) {
  Journal journal;
  JournalView view = journal.view;
  const std::uint64_t last_lap = (std::uint64_t{1} << kLapBits) - 2;
  const std::uint64_t position = last_lap << kBits;
  JournalEntry entry;
  const auto put = [&](std::uint64_t at) {
    publish(view.slot(at), 0, 0, 0, view.lap(at) << 4U | 1U);
  };

  put(position);
  EXPECT_EQ(fetch_at(view, position, entry), Fetched::Entry);
  EXPECT_EQ(fetch_at(view, position + kLength, entry), Fetched::NotYet);
  put(position + 2 * kLength);  // the lap number wraps
  EXPECT_EQ(fetch_at(view, position, entry), Fetched::Gone);
  EXPECT_EQ(fetch_at(view, position + 2 * kLength, entry), Fetched::Entry);
}

// A writer stores a hint after every 64th entry: these writers die before the hint.
TEST(Journal, FindsItsEndAfterManyDeathsBeforeAHint) {
  Journal journal;
  for (std::uint64_t life = 1; life <= 4; ++life) {
    JournalWriter writer{journal.view};
    const std::uint64_t hint = journal.head.hint;
    for (std::uint32_t i = 0; i < kHintEvery; ++i) writer.word(i, i);
    journal.head.hint = hint;

    EXPECT_EQ(end_of(journal.view), life * kHintEvery);
  }
}

// One thread writes without pause, one reads. Every entry that is read is whole and at its
// position, even if the writer overwrites entries before they are read.
TEST(Journal, IsNeverReadTorn) {
  Journal journal;
  constexpr std::uint32_t kWrites = 400'000;
  std::atomic<bool> finished{false};
  std::atomic<long> read{0};
  std::thread thread{[&] {
    JournalWriter writer{journal.view};
    for (std::uint32_t i = 0; i < kWrites; ++i) {
      writer.word_of((i ^ 0x5A5A5A5AU) - 1, i, ~i);
      // Ensures that the reader reads at least once: waits before anything is overwritten.
      while (i == kLength / 2 && read.load() == 0) std::this_thread::yield();
      if (i % 1000 == 0) std::this_thread::yield();
    }
    finished.store(true);
  }};
  std::uint64_t position = 0;
  JournalEntry entry;
  while (!finished.load() || position < kWrites) {
    switch (fetch_at(journal.view, position, entry)) {
      case Fetched::Entry:
        ASSERT_EQ(entry.a, static_cast<std::uint32_t>(position));
        ASSERT_EQ(entry.b, ~entry.a);
        ASSERT_EQ(entry.c, entry.a ^ 0x5A5A5A5AU);
        ++read;
        ++position;
        break;
      case Fetched::Gone:
        position = end_of(journal.view);
        break;
      case Fetched::NotYet:
        std::this_thread::yield();
        break;
    }
  }
  thread.join();

  EXPECT_GT(read, 0);
  EXPECT_EQ(end_of(journal.view), kWrites);
}

TEST(Journal, IsWrittenAndReadInRealTime) {
  Journal journal;
  JournalWriter writer{journal.view};
  const std::array<std::uint32_t, 20> words{};
  std::array<std::uint32_t, 20> read{};
  bool whole = false;
  EXPECT_REALTIME(writer.word(1, 2));
  EXPECT_REALTIME(writer.time(3, Duration{0}));
  EXPECT_REALTIME(writer.group(0, words, 0));
  const std::uint64_t position = end_of(journal.view) - group_entries(words.size());
  EXPECT_REALTIME(whole = read_journalled_group(journal.view, position, 0, read));
  EXPECT_TRUE(whole);
}

}  // namespace
}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "broker/src/record.hpp"
#include "support/whole_longwords.hpp"

namespace rths::broker {
namespace {

/// Lengths on both sides of every change of kind and of vector count.
constexpr std::uint32_t kRecordLengths[] = {1, 7, 8, 15, 16, 17, 31, 48, 100, 256};

struct alignas(128) Bytes {
  std::uint32_t words[32];
};

class Record : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  [[nodiscard]] std::vector<std::uint32_t> counting(std::uint32_t from) const {
    std::vector<std::uint32_t> words(length);
    for (std::uint32_t i = 0; i < length; ++i) words[i] = from + i;
    return words;
  }
  std::uint32_t length = GetParam();
  std::vector<Bytes> memory = std::vector<Bytes>(record_bytes(GetParam()) / sizeof(Bytes));
  std::uint32_t* record = memory[0].words;
  void write(const std::vector<std::uint32_t>& words) {
    write_record(record, words, count_of(record));
  }
};

TEST_P(Record, ReadsItsNewestWrite) {
  std::vector<std::uint32_t> read(length);
  for (std::uint32_t i = 0; i < 10; ++i) {
    write(counting(1000 * i));
    ASSERT_TRUE(read_record(record, read));
    EXPECT_EQ(read, counting(1000 * i));
    EXPECT_FALSE(is_torn(record, length));
  }
}

// While a record is disabled, the group is in memory only.
TEST_P(Record, IsNotReadWhileItIsDisabled) {
  std::vector<std::uint32_t> read(length);
  write(counting(1));

  disable_record(record);

  EXPECT_FALSE(read_record(record, read));
  EXPECT_FALSE(is_torn(record, length));
  ASSERT_TRUE(read_memory(record, counting(7).data(), read));
  EXPECT_EQ(read, counting(7));
  write(counting(3));
  EXPECT_FALSE(read_memory(record, counting(7).data(), read));
  ASSERT_TRUE(read_record(record, read));
  EXPECT_EQ(read, counting(3));
}

// Starts just before the count wraps.
TEST_P(Record, WorksWhenItsCountWraps) {
  std::vector<std::uint32_t> read(length);
  record[0] = record_kind(length) == RecordKind::Latch ? kDisabled - 1 : kDisabled - 2;
  for (std::uint32_t i = 0; i < 4; ++i) {
    write(counting(i));
    ASSERT_TRUE(read_record(record, read));
    EXPECT_EQ(read, counting(i));
    EXPECT_TRUE(is_enabled(record));
  }
}

TEST_P(Record, WritesOnlyItsOwnBytes) {
  std::vector<Bytes> larger(memory.size() + 1);
  for (auto& word : larger.back().words) word = 0xABCD;
  write_record(larger[0].words, counting(1), 0);

  for (const auto word : larger.back().words) EXPECT_EQ(word, 0xABCDU);
}

// A writer that died in the middle left an odd count. Its successor's next write repairs the
// record.
TEST_P(Record, IsWholeAgainAfterTheNextWrite) {
  if (record_kind(length) == RecordKind::Latch) return;  // has no middle
  std::vector<std::uint32_t> read(length);
  write(counting(1));
  record[0] |= 1U;
  EXPECT_TRUE(is_torn(record, length));
  EXPECT_FALSE(read_record(record, read));
  ASSERT_TRUE(read_memory(record, counting(1).data(), read));
  EXPECT_EQ(read, counting(1));

  write(counting(5));

  EXPECT_FALSE(is_torn(record, length));
  ASSERT_TRUE(read_record(record, read));
  EXPECT_EQ(read, counting(5));
}

/// All copy functions that this processor supports.
TEST(Words, AreCopiedWithoutTouchingTheirNeighbours) {
  constexpr std::uint32_t kGuard = 0xABCD;
  constexpr std::size_t kMost = 70;
  std::vector<std::uint32_t> from(kMost + 2);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<std::uint32_t>(100 + i);
  for (const auto copy : detail::copies()) {
    for (std::size_t count = 0; count <= kMost; ++count) {
      std::vector<std::uint32_t> to(kMost + 2, kGuard);
      copy(&to[1], &from[1], count);
      EXPECT_EQ(to[0], kGuard);
      for (std::size_t i = 1; i <= count; ++i) ASSERT_EQ(to[i], from[i]) << i << " of " << count;
      for (std::size_t i = count + 1; i < to.size(); ++i) ASSERT_EQ(to[i], kGuard) << count;
    }
  }
}

// A latch has the last whole write even while the next one is being written.
// Programs with a plain pointer read the words of a group in memory one by one. Vectors begin and
// end between longwords.
TEST(Words, AreCopiedWithoutTearingALongword) {
  constexpr std::size_t kWords = 1003;
  std::vector<std::uint32_t> shared(kWords + 2);
  std::vector<std::uint32_t> own(kWords);
  for (const auto copy : detail::copies()) {
    std::uint64_t copied = 0;
    std::uint32_t number = 0;
    const test::StressEnd end;
    test::LongwordReader reader{shared};
    for (; !end.reached(copied, reader.changes()); copied += kWords) {
      std::fill(own.begin(), own.end(), test::whole_longword(++number));
      copy(shared.data() + number % 3, own.data(), kWords);
    }
    const test::Seen seen = reader.stop();
    EXPECT_EQ(seen.torn, 0U) << "of " << copied;
    EXPECT_GE(copied, end.longwords());
    EXPECT_GE(seen.changes, test::StressEnd::kChanges);
  }
}

TEST(Words, AreReadWithoutTearingALongword) {
  constexpr std::size_t kWords = 1003;
  std::vector<std::uint32_t> shared(kWords + 2);
  std::vector<std::uint32_t> own(kWords);
  for (const auto copy : detail::copies()) {
    test::Seen seen;
    const test::StressEnd end;
    const test::LongwordWriter writer{shared};
    for (std::size_t i = 0; !end.reached(seen.longwords, seen.changes); ++i) {
      copy(own.data(), shared.data() + i % 3, kWords);
      seen.add_block(reinterpret_cast<const std::byte*>(own.data()), 4 * kWords);
    }
    EXPECT_EQ(seen.torn, 0U) << "of " << seen.longwords;
    EXPECT_GE(seen.longwords, end.longwords());
    EXPECT_GE(seen.changes, test::StressEnd::kChanges);
  }
}

TEST(Latch, NeverWaitsForItsWriter) {
  std::vector<Bytes> memory(1);
  const std::vector<std::uint32_t> first{1, 2, 3, 4, 5, 6, 7};
  write_record(memory[0].words, first, 0);
  std::uint32_t* half_written = memory[0].words + 2 + kLatchWords * ((memory[0].words[0] + 1) % 2);
  half_written[0] = 99;
  std::vector<std::uint32_t> read(7);

  ASSERT_TRUE(read_record(memory[0].words, read));
  EXPECT_EQ(read, first);
}

TEST_P(Record, IsNeverReadTorn) {
  constexpr std::uint32_t kWrites = 100'000;
  std::atomic<bool> finished{false};
  std::atomic<long> whole{0};
  std::thread writer{[&] {
    for (std::uint32_t count = 1; count <= kWrites; ++count) {
      while (count == kWrites / 2 && whole.load() == 0) std::this_thread::yield();
      write(std::vector<std::uint32_t>(length, count));
      if (count % 500 == 0) std::this_thread::yield();
    }
    finished.store(true);
  }};
  long torn = 0;
  std::vector<std::uint32_t> read(length);
  while (!finished.load()) {
    if (!read_record(record, read)) continue;
    ++whole;
    for (const auto word : read) torn += word != read[0] ? 1 : 0;
  }
  writer.join();

  EXPECT_EQ(torn, 0);
  ASSERT_TRUE(read_record(record, read));
  EXPECT_EQ(read[0], kWrites);
}

INSTANTIATE_TEST_SUITE_P(Words, Record, ::testing::ValuesIn(kRecordLengths));

}  // namespace
}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
//
// A tear group is kept twice: in its record, laid out so that a reader touches as few cache lines as
// its length allows, and in memory, where clients look that know nothing of records. A write goes
// through the record, then through memory; so one of the two is whole at any instant, and the
// record's count says which: it is odd while the record is not. One writer.
//
// Both are sequence locks in the fence-free form: data stored with release and loaded with acquire,
// so that a reader that saw any new word also sees the mark that was set before it.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

namespace rths::broker {

enum class RecordKind : std::uint32_t {
  Latch,  ///< up to 7 words: two copies and a count in one line; never waits for a writer
  Line,   ///< up to 15 words: count and words in one line
  Bulk,   ///< more: the count's line, and the words in the lines right behind it
};

inline constexpr std::uint32_t kLatchWords = 7;
inline constexpr std::uint32_t kLineWords = 15;
inline constexpr std::size_t kLineBytes = 64;
inline constexpr std::size_t kPairBytes = 128;  ///< lines that the processor fetches together
/// Beside a count: nobody keeps this record, and the group is what stands in memory.
inline constexpr std::uint32_t kPlain = 1U << 31U;

[[nodiscard]] constexpr RecordKind record_kind(std::size_t longwords) noexcept {
  if (longwords <= kLatchWords) return RecordKind::Latch;
  return longwords <= kLineWords ? RecordKind::Line : RecordKind::Bulk;
}

/// A multiple of a pair of lines: records of two writers never share one.
[[nodiscard]] constexpr std::size_t record_bytes(std::size_t longwords) noexcept {
  if (record_kind(longwords) != RecordKind::Bulk) return kPairBytes;
  const std::size_t bytes = kLineBytes + longwords * sizeof(std::uint32_t);
  return (bytes + kPairBytes - 1) / kPairBytes * kPairBytes;
}

/// Copies words one at a time, or many at once where the processor can and the build lets it.
void store_words(std::uint32_t* to, std::span<const std::uint32_t> words) noexcept;
void load_words(std::span<std::uint32_t> words, const std::uint32_t* from) noexcept;

/// Counts wrap below the mark.
[[nodiscard]] constexpr std::uint32_t next_count(std::uint32_t count) noexcept {
  return (count + 1) & ~kPlain;
}

namespace detail {
inline std::atomic_ref<std::uint32_t> at(std::uint32_t& word) noexcept {
  return std::atomic_ref{word};
}
/// Where the words of a write lie that made the count what it is.
inline std::uint32_t* words_of(std::uint32_t* record, RecordKind kind,
                               std::uint32_t count) noexcept {
  switch (kind) {
    case RecordKind::Latch:
      return record + 2 + (count % 2) * kLatchWords;
    case RecordKind::Line:
      return record + 1;
    case RecordKind::Bulk:
      break;
  }
  return record + kLineBytes / sizeof *record;
}
}  // namespace detail

[[nodiscard]] inline std::uint32_t count_of(std::uint32_t* record) noexcept {
  return detail::at(record[0]).load(std::memory_order_acquire);
}
[[nodiscard]] inline bool is_kept(std::uint32_t* record) noexcept {
  return (count_of(record) & kPlain) == 0;
}
/// From now on, the group is what stands in memory.
inline void keep_no_longer(std::uint32_t* record) noexcept {
  detail::at(record[0]).store(count_of(record) | kPlain, std::memory_order_release);
}

/// @param record  as many bytes as `record_bytes`, aligned to a pair of lines
inline void write_record(std::uint32_t* record, std::span<const std::uint32_t> words) noexcept {
  using detail::at;
  const RecordKind kind = record_kind(words.size());
  const std::uint32_t count = at(record[0]).load(std::memory_order_relaxed);
  if (kind == RecordKind::Latch) {
    store_words(detail::words_of(record, kind, next_count(count)), words);
    at(record[0]).store(next_count(count), std::memory_order_release);
    return;
  }
  const std::uint32_t middle = (count | 1U) & ~kPlain;  // odd already if a predecessor died here
  // Behind the last write's words in memory, which whoever sees this may turn to.
  at(record[0]).store(middle, std::memory_order_release);
  store_words(detail::words_of(record, kind, middle), words);
  at(record[0]).store(next_count(middle), std::memory_order_release);
}

/// One attempt. False: the writer is, or was, in the middle, or nobody keeps the record.
[[nodiscard]] inline bool read_record(std::uint32_t* record,
                                      std::span<std::uint32_t> words) noexcept {
  const RecordKind kind = record_kind(words.size());
  const std::uint32_t count = count_of(record);
  const bool is_odd = kind != RecordKind::Latch && count % 2 != 0;
  if (is_odd || (count & kPlain) != 0) return false;
  // The copy that a latch's count names is written again only after the next count was published.
  load_words(words, detail::words_of(record, kind, count));
  return detail::at(record[0]).load(std::memory_order_relaxed) == count;
}

/// One attempt at the group's words in memory. False: they are not whole, or were not all the time.
[[nodiscard]] inline bool read_memory(std::uint32_t* record, const std::uint32_t* memory,
                                      std::span<std::uint32_t> words) noexcept {
  const std::uint32_t count = count_of(record);
  const bool is_odd = record_kind(words.size()) != RecordKind::Latch && count % 2 != 0;
  if (!is_odd && (count & kPlain) == 0) return false;
  load_words(words, memory);
  return detail::at(record[0]).load(std::memory_order_relaxed) == count;
}

/// True if the record's writer stopped in the middle of it.
[[nodiscard]] inline bool is_torn(std::uint32_t* record, std::size_t longwords) noexcept {
  return record_kind(longwords) != RecordKind::Latch && is_kept(record) &&
         count_of(record) % 2 != 0;
}

}  // namespace rths::broker

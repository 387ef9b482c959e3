// SPDX-License-Identifier: Apache-2.0
//
// A tear group is stored twice: in its record, where a reader touches as few cache lines as
// possible, and in memory, for clients without records. A write first changes the record, then
// memory, so one of the two is whole at any instant. The record's count shows which: odd means
// memory. (A latch is always whole.) One writer.
//
// Counts wrap: a reader that pauses for exactly 2^30 writes, 12 days at one per millisecond, takes
// the last one for the one it has.
//
// Both are sequence locks in the fence-free form: data is stored with release and loaded with
// acquire, so a reader that sees any new word also sees the mark that was set before it.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#if defined(RTHS_VECTOR_COPIES) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#include <emmintrin.h>
#define RTHS_VECTORS 1
#endif

namespace rths::broker {

enum class RecordKind : std::uint32_t {
  Latch,  ///< up to 7 words: a count and two copies in one line; readers never wait for the writer
  Line,   ///< up to 15 words: count and words in one line
  Bulk,   ///< more: the count's line, then the words in the next lines
};

inline constexpr std::uint32_t kLatchWords = 7;
inline constexpr std::uint32_t kLineWords = 15;
inline constexpr std::size_t kLineBytes = 64;
inline constexpr std::size_t kPairBytes =
    128;  ///< pair of lines that the processor fetches together
/// Flag in a count: the record is not used; the group is in memory only.
inline constexpr std::uint32_t kDisabled = 1U << 31U;

[[nodiscard]] constexpr RecordKind record_kind(std::size_t longwords) noexcept {
  if (longwords <= kLatchWords) return RecordKind::Latch;
  return longwords <= kLineWords ? RecordKind::Line : RecordKind::Bulk;
}

/// Size of a record [B]: whole pairs of lines, so records of two writers share none.
[[nodiscard]] constexpr std::size_t record_bytes(std::size_t longwords) noexcept {
  if (record_kind(longwords) != RecordKind::Bulk) return kPairBytes;
  const std::size_t bytes = kLineBytes + longwords * sizeof(std::uint32_t);
  return (bytes + kPairBytes - 1) / kPairBytes * kPairBytes;
}

namespace detail {

inline std::atomic_ref<std::uint32_t> at(std::uint32_t& word) noexcept {
  return std::atomic_ref{word};
}

#ifdef RTHS_VECTORS
// x86-64 keeps stores in order and loads in order, also of vectors; the fences bind the compiler.
// A vector may be seen in pieces: the count detects it. No vector extends beyond the end, not even
// masked: it would touch the next line, which may belong to another writer.
inline void copy_four(std::uint32_t* to, const std::uint32_t* from) noexcept {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                   _mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}

// Fewer than 16 words: vectors at both ends, which may overlap. Without a loop, whose end a
// processor would mispredict.
inline void copy_few(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  if (count >= 4) {
    copy_four(to, from);
    if (count >= 8) {
      copy_four(to + 4, from + 4);
      copy_four(to + count - 8, from + count - 8);
    }
    copy_four(to + count - 4, from + count - 4);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) at(to[i]).store(from[i], std::memory_order_relaxed);
}
void copy_many(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept;
#endif

using Copy = void (*)(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept;
/// All copy functions that this processor supports, for tests.
[[nodiscard]] std::vector<Copy> copies();

}  // namespace detail

/// Copies words; by vectors if the processor and the build support it.
inline void store_words(std::uint32_t* to, std::span<const std::uint32_t> words) noexcept {
#ifdef RTHS_VECTORS
  std::atomic_signal_fence(std::memory_order_seq_cst);
  if (words.size() <= kLineWords)
    detail::copy_few(to, words.data(), words.size());
  else
    detail::copy_many(to, words.data(), words.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
#else
  for (std::size_t i = 0; i < words.size(); ++i)
    detail::at(to[i]).store(words[i], std::memory_order_release);
#endif
}
inline void load_words(std::span<std::uint32_t> words, const std::uint32_t* from) noexcept {
#ifdef RTHS_VECTORS
  store_words(words.data(), {from, words.size()});
#else
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = detail::at(const_cast<std::uint32_t&>(from[i])).load(std::memory_order_acquire);
#endif
}

/// The next count; wraps below the flag kDisabled.
[[nodiscard]] constexpr std::uint32_t next_count(std::uint32_t count) noexcept {
  return (count + 1) & ~kDisabled;
}

namespace detail {
/// Address of the words of the write with this count.
inline std::uint32_t* words_of(std::uint32_t* record, RecordKind kind,
                               std::uint32_t count) noexcept {
  if (kind == RecordKind::Latch) return record + 2 + std::size_t{count % 2} * kLatchWords;
  return record + (kind == RecordKind::Line ? 1 : kLineBytes / sizeof *record);
}

// The time of a bulk record is the transfer of its cache lines. The writer prefetches all of them
// at once and demotes them to the shared cache when they are written; a reader demotes them too, if
// they are few.
void prefetch_lines(const std::uint32_t* begin, std::size_t bytes) noexcept;
void demote_lines(const std::uint32_t* begin, std::size_t bytes) noexcept;
inline constexpr std::size_t kFewLines = 8;
}  // namespace detail

/// True if, at this count, the record is whole; otherwise the group's words in memory are.
[[nodiscard]] constexpr bool record_is_whole(std::uint32_t count, RecordKind kind) noexcept {
  const bool is_odd = kind != RecordKind::Latch && count % 2 != 0;
  return !is_odd && (count & kDisabled) == 0;
}

[[nodiscard]] inline std::uint32_t count_of(std::uint32_t* record) noexcept {
  return std::atomic_ref{record[0]}.load(std::memory_order_acquire);
}
[[nodiscard]] inline bool is_enabled(std::uint32_t* record) noexcept {
  return (count_of(record) & kDisabled) == 0;
}
/// Disables a record: from now on the group is in memory only.
inline void disable_record(std::uint32_t* record) noexcept {
  std::atomic_ref{record[0]}.store(count_of(record) | kDisabled, std::memory_order_release);
}

/// Writes a record.
/// @param record  `record_bytes` bytes, aligned to a pair of lines
/// @param count   of the previous write; the writer keeps it, since reading it would fetch the line
///                back from its readers
/// @returns the count of this write
inline std::uint32_t write_record(std::uint32_t* record, std::span<const std::uint32_t> words,
                                  std::uint32_t count) noexcept {
  using detail::at;
  const RecordKind kind = record_kind(words.size());
  if (kind == RecordKind::Latch) {
    const std::uint32_t next = next_count(count);
    store_words(detail::words_of(record, kind, next), words);
    at(record[0]).store(next, std::memory_order_release);
    return next;
  }
  const std::uint32_t middle = (count | 1U) & ~kDisabled;  // odd already if a predecessor died here
  const std::uint32_t next = next_count(middle);
  std::uint32_t* to = detail::words_of(record, kind, middle);
  const bool is_bulk = kind == RecordKind::Bulk;
  if (is_bulk) detail::prefetch_lines(record, record_bytes(words.size()));
  // After the last write's words in memory: a reader that sees this count reads those.
  at(record[0]).store(middle, std::memory_order_release);
  store_words(to, words);
  at(record[0]).store(next, std::memory_order_release);
  if (is_bulk) detail::demote_lines(to, words.size_bytes());
  return next;
}

/// Tries once to read the write with this count. False: the writer is, or was meanwhile, in the
/// middle of the next write, or the record is disabled.
[[nodiscard]] inline bool read_record(std::uint32_t* record, std::span<std::uint32_t> words,
                                      std::uint32_t count) noexcept {
  const RecordKind kind = record_kind(words.size());
  if (!record_is_whole(count, kind)) return false;
  // The writer reuses this copy of a latch only after it has published the next count.
  const std::uint32_t* from = detail::words_of(record, kind, count);
  load_words(words, from);
  if (detail::at(record[0]).load(std::memory_order_relaxed) != count) return false;
  if (kind == RecordKind::Bulk && words.size_bytes() <= detail::kFewLines * kLineBytes)
    detail::demote_lines(from, words.size_bytes());
  return true;
}
[[nodiscard]] inline bool read_record(std::uint32_t* record,
                                      std::span<std::uint32_t> words) noexcept {
  return read_record(record, words, count_of(record));
}

/// Tries once to read the group's words in memory. False: they were not whole the whole time.
[[nodiscard]] inline bool read_memory(std::uint32_t* record, const std::uint32_t* memory,
                                      std::span<std::uint32_t> words) noexcept {
  const std::uint32_t count = count_of(record);
  if (record_is_whole(count, record_kind(words.size()))) return false;
  load_words(words, memory);
  return detail::at(record[0]).load(std::memory_order_relaxed) == count;
}

/// True if the record's writer stopped in the middle of a write.
[[nodiscard]] inline bool is_torn(std::uint32_t* record, std::size_t longwords) noexcept {
  return is_enabled(record) && !record_is_whole(count_of(record), record_kind(longwords));
}

}  // namespace rths::broker

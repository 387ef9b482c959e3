// SPDX-License-Identifier: Apache-2.0
//
// A tear group is kept twice: in its record, laid out so that a reader touches as few cache lines
// as its length allows, and in memory, where clients look that know nothing of records. A write
// goes through the record, then through memory; so one of the two is whole at any instant, and the
// record's count says which: it is odd while memory is. (A latch is whole at any instant by
// itself.) One writer. Counts wrap: a reader that rests through exactly 2^30 writes, 12 days of one
// each millisecond, takes the last of them for the one that it has.
//
// Both are sequence locks in the fence-free form: data stored with release and loaded with acquire,
// so that a reader that saw any new word also sees the mark that was set before it.
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

namespace detail {

inline std::atomic_ref<std::uint32_t> at(std::uint32_t& word) noexcept {
  return std::atomic_ref{word};
}

#ifdef RTHS_VECTORS
// x86-64 keeps stores in order and loads in order, vectors too; the fences hold the compiler to it.
// That a vector may be seen in parts does not matter: the count around it tells. None reaches over
// the end, not even masked: it would touch the next line, which may be somebody else's.
inline void copy_four(std::uint32_t* to, const std::uint32_t* from) noexcept {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                   _mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}

// Less than 16: those at both ends, which may meet in the middle. No loop, whose end a processor
// could not foresee.
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
/// All ways to copy that this processor has, for tests.
[[nodiscard]] std::vector<Copy> copies();

}  // namespace detail

/// Copies words: several at once where the processor can and the build lets it.
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

/// Counts wrap below the mark.
[[nodiscard]] constexpr std::uint32_t next_count(std::uint32_t count) noexcept {
  return (count + 1) & ~kPlain;
}

namespace detail {
/// Where the words of a write lie that made the count what it is.
inline std::uint32_t* words_of(std::uint32_t* record, RecordKind kind,
                               std::uint32_t count) noexcept {
  switch (kind) {
    case RecordKind::Latch:
      return record + 2 + std::size_t{count % 2} * kLatchWords;
    case RecordKind::Line:
      return record + 1;
    case RecordKind::Bulk:
      break;
  }
  return record + kLineBytes / sizeof *record;
}

// What a record of several lines takes is its lines changing hands. Its writer asks for all of them
// at once, and passes them on when they are written; who has read them does so too, if they are
// few.
void ask_for_lines(const std::uint32_t* begin, std::size_t bytes) noexcept;
void pass_on_lines(const std::uint32_t* begin, std::size_t bytes) noexcept;
inline constexpr std::size_t kFewLines = 8;
}  // namespace detail

/// Whether the record is what to read at this count, and not the group's words in memory.
[[nodiscard]] constexpr bool record_is_whole(std::uint32_t count, RecordKind kind) noexcept {
  const bool is_odd = kind != RecordKind::Latch && count % 2 != 0;
  return !is_odd && (count & kPlain) == 0;
}

[[nodiscard]] inline std::uint32_t count_of(std::uint32_t* record) noexcept {
  return std::atomic_ref{record[0]}.load(std::memory_order_acquire);
}
[[nodiscard]] inline bool is_kept(std::uint32_t* record) noexcept {
  return (count_of(record) & kPlain) == 0;
}
/// From now on, the group is what stands in memory.
inline void keep_no_longer(std::uint32_t* record) noexcept {
  std::atomic_ref{record[0]}.store(count_of(record) | kPlain, std::memory_order_release);
}

/// @param record  as many bytes as `record_bytes`, aligned to a pair of lines
/// @param count   of the write before, which a writer remembers: to look it up would fetch the line
///                back from its readers first
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
  const std::uint32_t middle = (count | 1U) & ~kPlain;  // odd already if a predecessor died here
  const std::uint32_t next = next_count(middle);
  std::uint32_t* to = detail::words_of(record, kind, middle);
  const bool is_bulk = kind == RecordKind::Bulk;
  if (is_bulk) detail::ask_for_lines(record, record_bytes(words.size()));
  // Behind the last write's words in memory, which whoever sees this may turn to.
  at(record[0]).store(middle, std::memory_order_release);
  store_words(to, words);
  at(record[0]).store(next, std::memory_order_release);
  if (is_bulk) detail::pass_on_lines(to, words.size_bytes());
  return next;
}

/// One attempt at the write that made the count what it is. False: the writer is, or was, in the
/// middle of the next one, or nobody keeps the record.
[[nodiscard]] inline bool read_record(std::uint32_t* record, std::span<std::uint32_t> words,
                                      std::uint32_t count) noexcept {
  const RecordKind kind = record_kind(words.size());
  if (!record_is_whole(count, kind)) return false;
  // The copy that a latch's count names is written again only after the next count was published.
  const std::uint32_t* from = detail::words_of(record, kind, count);
  load_words(words, from);
  if (detail::at(record[0]).load(std::memory_order_relaxed) != count) return false;
  if (kind == RecordKind::Bulk && words.size_bytes() <= detail::kFewLines * kLineBytes)
    detail::pass_on_lines(from, words.size_bytes());
  return true;
}
[[nodiscard]] inline bool read_record(std::uint32_t* record,
                                      std::span<std::uint32_t> words) noexcept {
  return read_record(record, words, count_of(record));
}

/// One attempt at the group's words in memory. False: they are not whole, or were not all the time.
[[nodiscard]] inline bool read_memory(std::uint32_t* record, const std::uint32_t* memory,
                                      std::span<std::uint32_t> words) noexcept {
  const std::uint32_t count = count_of(record);
  if (record_is_whole(count, record_kind(words.size()))) return false;
  load_words(words, memory);
  return detail::at(record[0]).load(std::memory_order_relaxed) == count;
}

/// True if the record's writer stopped in the middle of it.
[[nodiscard]] inline bool is_torn(std::uint32_t* record, std::size_t longwords) noexcept {
  return is_kept(record) && !record_is_whole(count_of(record), record_kind(longwords));
}

}  // namespace rths::broker

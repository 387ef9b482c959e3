// SPDX-License-Identifier: Apache-2.0
//
// Where a tear group is read and written whole: a copy of its words, laid out so that a reader
// touches as few cache lines as its length allows. One writer.
//
// All three are sequence locks in the fence-free form: data stored with release and loaded with
// acquire, so that a reader that saw any new word also sees the mark that was set before it.
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

[[nodiscard]] constexpr RecordKind record_kind(std::uint32_t longwords) noexcept {
  if (longwords <= kLatchWords) return RecordKind::Latch;
  return longwords <= kLineWords ? RecordKind::Line : RecordKind::Bulk;
}

/// A multiple of a pair of lines: records of two writers never share one.
[[nodiscard]] constexpr std::size_t record_bytes(std::uint32_t longwords) noexcept {
  if (record_kind(longwords) != RecordKind::Bulk) return kPairBytes;
  const std::size_t bytes = kLineBytes + longwords * sizeof(std::uint32_t);
  return (bytes + kPairBytes - 1) / kPairBytes * kPairBytes;
}

/// Copies words one at a time, or many at once where the processor can and the build lets it.
void store_words(std::uint32_t* to, std::span<const std::uint32_t> words) noexcept;
void load_words(std::span<std::uint32_t> words, const std::uint32_t* from) noexcept;

namespace detail {
inline std::atomic_ref<std::uint32_t> at(std::uint32_t& word) noexcept {
  return std::atomic_ref{word};
}
}  // namespace detail

/// @param record  as many bytes as `record_bytes`, aligned to a pair of lines
inline void write_record(std::uint32_t* record, std::span<const std::uint32_t> words) noexcept {
  using detail::at;
  const std::uint32_t count = at(record[0]).load(std::memory_order_relaxed);
  const std::uint32_t middle = count | 1U;  // odd already if a predecessor died here
  switch (record_kind(static_cast<std::uint32_t>(words.size()))) {
    case RecordKind::Latch: {
      std::uint32_t* copy = record + 2 + ((count + 1) % 2) * kLatchWords;
      for (std::size_t i = 0; i < words.size(); ++i)
        at(copy[i]).store(words[i], std::memory_order_release);
      at(record[0]).store(count + 1, std::memory_order_release);
      return;
    }
    case RecordKind::Line:
      at(record[0]).store(middle, std::memory_order_relaxed);
      for (std::size_t i = 0; i < words.size(); ++i)
        at(record[1 + i]).store(words[i], std::memory_order_release);
      at(record[0]).store(middle + 1, std::memory_order_release);
      return;
    case RecordKind::Bulk:
      at(record[0]).store(middle, std::memory_order_relaxed);
      store_words(record + kLineBytes / sizeof *record, words);
      at(record[0]).store(middle + 1, std::memory_order_release);
      return;
  }
}

/// One attempt. False: the writer is, or was, in the middle, or nobody ever wrote.
[[nodiscard]] inline bool read_record(std::uint32_t* record,
                                      std::span<std::uint32_t> words) noexcept {
  using detail::at;
  const std::uint32_t count = at(record[0]).load(std::memory_order_acquire);
  if (count == 0) return false;
  switch (record_kind(static_cast<std::uint32_t>(words.size()))) {
    case RecordKind::Latch: {
      // The copy that this count names is written again only after the next count was published.
      std::uint32_t* copy = record + 2 + (count % 2) * kLatchWords;
      for (std::size_t i = 0; i < words.size(); ++i)
        words[i] = at(copy[i]).load(std::memory_order_acquire);
      break;
    }
    case RecordKind::Line:
      if (count % 2 != 0) return false;
      for (std::size_t i = 0; i < words.size(); ++i)
        words[i] = at(record[1 + i]).load(std::memory_order_acquire);
      break;
    case RecordKind::Bulk:
      if (count % 2 != 0) return false;
      load_words(words, record + kLineBytes / sizeof *record);
      break;
  }
  return at(record[0]).load(std::memory_order_relaxed) == count;
}

/// True if the record's writer stopped in the middle of it.
[[nodiscard]] inline bool is_torn(std::uint32_t* record, std::uint32_t longwords) noexcept {
  return record_kind(longwords) != RecordKind::Latch &&
         detail::at(record[0]).load(std::memory_order_acquire) % 2 != 0;
}

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
//
// A writer's journal: all its writes, in order, in shared memory. One writer, any number of
// readers; the writer does not depend on them. One 16-byte store publishes an entry. An entry is
// valid if its lap is that of its position.
//
// Internal: in a header so that the compiler can inline `Node::write`.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#include <emmintrin.h>
#define RTHS_ONE_STORE 1
#endif

#include <rths/core/clock.hpp>
namespace rths::broker {

enum class EntryKind : std::uint32_t {
  Word = 1,   ///< a: offset, b: value, c: node on whose behalf it was written, plus 1
  Group = 2,  ///< a: offset of the first word, b: longwords, c: count of the record's write; its
              ///< words follow as Data
  Data = 3,   ///< a, b, c: the next three words of a group
  Time = 4,   ///< a, b: CLOCK_MONOTONIC [ns], low and high half; later entries are later;
              ///< c: by how much the writes before it were late [ns]
};

struct alignas(16) JournalEntry {
  std::uint32_t a = 0, b = 0, c = 0;
  std::uint32_t tag = 0;  ///< lap in the upper 28 bits, kind in the lower 4; 0: never written

  [[nodiscard]] EntryKind kind() const noexcept { return static_cast<EntryKind>(tag & 0xFU); }
};

/// Precedes the entries, on a cache line of its own.
struct alignas(128) JournalHead {
  std::uint64_t hint;  ///< a position at or before the end, by at most kHintEvery
};
static_assert(sizeof(JournalEntry) == 16 && sizeof(JournalHead) == 128);

inline constexpr std::uint64_t kHintEvery = 64;
inline constexpr std::size_t kWordsPerEntry = 3;  ///< words of a group
inline constexpr std::uint32_t kLapBits = 28;

/// Address and size of a journal.
struct JournalView {
  JournalHead* head = nullptr;
  JournalEntry* entries = nullptr;
  std::uint32_t bits = 0;  ///< 2^bits entries

  [[nodiscard]] JournalEntry& slot(std::uint64_t position) const noexcept {
    return entries[position & ((std::uint64_t{1} << bits) - 1)];
  }
  /// Lap of a position: counted from 1, modulo 2^28.
  [[nodiscard]] std::uint32_t lap(std::uint64_t position) const noexcept {
    return static_cast<std::uint32_t>((position >> bits) + 1) & ((1U << kLapBits) - 1);
  }
};

constexpr std::uint64_t halves(std::uint32_t low, std::uint32_t high) noexcept {
  return static_cast<std::uint64_t>(high) << 32U | low;
}
constexpr std::uint32_t low_half(std::uint64_t both) noexcept {
  return static_cast<std::uint32_t>(both);
}
constexpr std::uint32_t high_half(std::uint64_t both) noexcept {
  return static_cast<std::uint32_t>(both >> 32U);
}

/// Publishes an entry atomically. A thread that sees it also sees all earlier stores of this one.
/// @param ab, ct  the entry's halves: a and b, c and tag
inline void publish(JournalEntry& to, std::uint64_t ab, std::uint64_t ct) noexcept {
#ifdef RTHS_ONE_STORE
  // x86-64 with AVX stores 16 aligned bytes atomically and keeps stores in order. The vector is
  // built from register halves: a load from memory would wait for the earlier stores.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  _mm_store_si128(reinterpret_cast<__m128i*>(&to),
                  _mm_set_epi64x(static_cast<std::int64_t>(ct), static_cast<std::int64_t>(ab)));
  std::atomic_signal_fence(std::memory_order_seq_cst);
#else
  // Three phases: invalidate, contents, tag. A reader of new contents also sees the old tag
  // cleared.
  auto* words = reinterpret_cast<std::uint32_t*>(&to);
  std::atomic_ref{words[3]}.store(0, std::memory_order_relaxed);
  std::atomic_ref{words[0]}.store(low_half(ab), std::memory_order_release);
  std::atomic_ref{words[1]}.store(high_half(ab), std::memory_order_release);
  std::atomic_ref{words[2]}.store(low_half(ct), std::memory_order_release);
  std::atomic_ref{words[3]}.store(high_half(ct), std::memory_order_release);
#endif
}
inline void publish(JournalEntry& to, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                    std::uint32_t tag) noexcept {
  publish(to, halves(a, b), halves(c, tag));
}

/// Publishes three words of a group. Reads a fourth word and ignores it.
inline void publish_words(JournalEntry& to, const std::uint32_t* words,
                          std::uint32_t tag) noexcept {
#ifdef RTHS_ONE_STORE
  const __m128i three = _mm_set_epi32(0, -1, -1, -1);
  const __m128i last = _mm_set_epi32(static_cast<int>(tag), 0, 0, 0);
  const __m128i four = _mm_loadu_si128(reinterpret_cast<const __m128i*>(words));
  std::atomic_signal_fence(std::memory_order_seq_cst);
  _mm_store_si128(reinterpret_cast<__m128i*>(&to), _mm_or_si128(_mm_and_si128(four, three), last));
  std::atomic_signal_fence(std::memory_order_seq_cst);
#else
  publish(to, words[0], words[1], words[2], tag);
#endif
}

/// Publishes words of a group in `entries_of` entries.
inline void publish_words(JournalEntry* to, std::span<const std::uint32_t> words,
                          std::uint32_t tag) noexcept {
  const std::size_t count = words.size();
  std::size_t i = 0;
  const auto three_more = [&] {
    publish_words(*to++, words.data() + i, tag);
    i += kWordsPerEntry;
  };
  // Short groups without a loop: a processor would mispredict the loop's end.
  if (count > 1 * kWordsPerEntry) three_more();
  if (count > 2 * kWordsPerEntry) three_more();
  if (count > 3 * kWordsPerEntry) three_more();
  if (count > 4 * kWordsPerEntry) three_more();
  while (i + kWordsPerEntry < count) three_more();
  const auto word = [&](std::size_t at) { return at < count ? words[at] : 0; };
  publish(*to, word(i), word(i + 1), word(i + 2), tag);
}

/// Number of entries for words of a group.
[[nodiscard]] constexpr std::size_t entries_of(std::size_t longwords) noexcept {
  return (longwords + kWordsPerEntry - 1) / kWordsPerEntry;
}

/// Number of entries of a group: the first, and those of its words.
[[nodiscard]] constexpr std::uint64_t group_entries(std::size_t longwords) noexcept {
  return 1 + entries_of(longwords);
}

/// Longest delay that an entry of kind Time has room for.
inline constexpr Duration kLongestLate{0xffffffff};

/// Appends to a journal. One per journal, in one thread.
class JournalWriter {
 public:
  JournalWriter() = default;
  /// Continues at the end of the journal, also after a predecessor that was killed.
  explicit JournalWriter(const JournalView& journal) noexcept;

  void word(std::uint32_t offset, std::uint32_t value) noexcept {
    JournalEntry* const to = next_;
    publish(*to, halves(offset, value), word_half_);
    advance_to(to + 1);
  }
  /// Appends a word that another node wrote without journalling it.
  void word_of(std::uint32_t node, std::uint32_t offset, std::uint32_t value) noexcept {
    append(EntryKind::Word, offset, value, node + 1);
  }
  /// @param count  of the record's write
  void group(std::uint32_t base, std::span<const std::uint32_t> words,
             std::uint32_t count) noexcept {
    const std::size_t entries = group_entries(words.size());
    JournalEntry* const to = next_;
    if (entries >= static_cast<std::size_t>(stop_ - to))
      return group_across_hint(base, words, count);
    const std::uint32_t data = tag(EntryKind::Data);
    publish(*to, base, static_cast<std::uint32_t>(words.size()), count, tag(EntryKind::Group));
    publish_words(to + 1, words, data);
    next_ = to + entries;
  }
  /// @param late  of the writes before it: they were due so much earlier
  void time(std::uint64_t nanoseconds, Duration late) noexcept {
    const auto bounded = std::clamp(late, Duration{0}, kLongestLate);
    append(EntryKind::Time, low_half(nanoseconds), high_half(nanoseconds),
           static_cast<std::uint32_t>(bounded.count()));
  }

 private:
  void append(EntryKind kind, std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept {
    publish(*next_, a, b, c, tag(kind));
    advance_to(next_ + 1);
  }
  [[nodiscard]] std::uint32_t tag(EntryKind kind) const noexcept {
    return lap_tag_ | static_cast<std::uint32_t>(kind);
  }
  /// Sets the next entry; stores a hint if one is due.
  void advance_to(JournalEntry* next) noexcept {
    next_ = next;
    if (next == stop_) [[unlikely]]
      publish_hint();
  }
  void group_across_hint(std::uint32_t base, std::span<const std::uint32_t> words,
                         std::uint32_t count) noexcept;
  /// Stores the position as a hint; begins a new lap at the end of the journal.
  void publish_hint() noexcept;
  void begin_at(std::uint64_t position) noexcept;
  [[nodiscard]] std::uint64_t position() const noexcept {
    return lap_begin_ + static_cast<std::uint64_t>(next_ - journal_.entries);
  }

  JournalEntry* next_ = nullptr;
  JournalEntry* stop_ = nullptr;  ///< the next hint is due here
  std::uint64_t word_half_ = 0;   ///< half of a word's entry; constant during a lap
  std::uint32_t lap_tag_ = 0;
  std::uint64_t lap_begin_ = 0;  ///< position of the lap's first entry
  JournalView journal_;
};

}  // namespace rths::broker

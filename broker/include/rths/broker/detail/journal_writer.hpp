// SPDX-License-Identifier: Apache-2.0
//
// A writer's journal: everything it wrote, in order, in shared memory. One writer, any number of
// readers, none of which it knows of. An entry is published by one 16-byte store, and says itself
// whether it is there: its lap is that of its position.
//
// Not for use: here only so that `Node::write` becomes part of the loop that calls it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#include <emmintrin.h>
#define RTHS_ONE_STORE 1
#endif

namespace rths::broker {

enum class EntryKind : std::uint32_t {
  Word = 1,   ///< a: offset, b: value, c: node on whose behalf it was written, plus 1
  Group = 2,  ///< a: offset of the first word, b: longwords, c: count of the record's write; its
              ///< words follow as Data
  Data = 3,   ///< a, b, c: the next three words of a group
  Time = 4,   ///< a, b: CLOCK_MONOTONIC [ns], low and high half; what follows is later
};

struct alignas(16) JournalEntry {
  std::uint32_t a = 0, b = 0, c = 0;
  std::uint32_t tag = 0;  ///< lap in the upper 28 bits, kind in the lower 4; 0: never written

  [[nodiscard]] EntryKind kind() const noexcept { return static_cast<EntryKind>(tag & 0xFU); }
};

/// In front of the entries, on a line of its own.
struct alignas(128) JournalHead {
  std::uint64_t hint;  ///< a position the writer has passed, at most kHintEvery behind its end
};
static_assert(sizeof(JournalEntry) == 16 && sizeof(JournalHead) == 128);

inline constexpr std::uint64_t kHintEvery = 64;
inline constexpr std::size_t kWordsPerEntry = 3;  ///< of a group
inline constexpr std::uint32_t kLapBits = 28;

/// Where a journal lies, and how long it is.
struct JournalPlace {
  JournalHead* head = nullptr;
  JournalEntry* entries = nullptr;
  std::uint32_t bits = 0;  ///< 2^bits entries

  [[nodiscard]] JournalEntry& slot(std::uint64_t position) const noexcept {
    return entries[position & ((std::uint64_t{1} << bits) - 1)];
  }
  /// Of the entry that belongs to a position: never 0 for the first 2^28 laps, then again.
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

/// Publishes an entry whole. Everything the thread stored before is visible to whoever sees it.
/// @param ab, ct  its halves: a and b, c and tag
inline void publish(JournalEntry& to, std::uint64_t ab, std::uint64_t ct) noexcept {
#ifdef RTHS_ONE_STORE
  // x86-64 with AVX stores aligned 16 bytes at once, and no store before another. Put together from
  // halves: by way of memory it would have to wait until everything before it is done.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  _mm_store_si128(reinterpret_cast<__m128i*>(&to),
                  _mm_set_epi64x(static_cast<std::int64_t>(ct), static_cast<std::int64_t>(ab)));
  std::atomic_signal_fence(std::memory_order_seq_cst);
#else
  // In three: void, contents, valid. Whoever sees new contents also sees that the old tag is gone.
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

/// Publishes three words of a group. The word behind them is read too, and not used.
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

/// Publishes words of a group in as many entries as they take.
inline void publish_words(JournalEntry* to, std::span<const std::uint32_t> words,
                          std::uint32_t tag) noexcept {
  const std::size_t count = words.size();
  std::size_t i = 0;
  const auto three_more = [&] {
    publish_words(*to++, words.data() + i, tag);
    i += kWordsPerEntry;
  };
  // The few of a line without a loop, whose end a processor could not foresee.
  if (count > 1 * kWordsPerEntry) three_more();
  if (count > 2 * kWordsPerEntry) three_more();
  if (count > 3 * kWordsPerEntry) three_more();
  if (count > 4 * kWordsPerEntry) three_more();
  while (i + kWordsPerEntry < count) three_more();
  const auto word = [&](std::size_t at) { return at < count ? words[at] : 0; };
  publish(*to, word(i), word(i + 1), word(i + 2), tag);
}

/// How many entries words of a group take.
[[nodiscard]] constexpr std::size_t entries_of(std::size_t longwords) noexcept {
  return (longwords + kWordsPerEntry - 1) / kWordsPerEntry;
}

/// How many entries a group takes: its first, and those of its words.
[[nodiscard]] constexpr std::uint64_t group_entries(std::size_t longwords) noexcept {
  return 1 + entries_of(longwords);
}

/// Appends to a journal. One per journal, in one thread.
class JournalWriter {
 public:
  JournalWriter() = default;
  /// Goes on where a predecessor ended, however it did.
  explicit JournalWriter(const JournalPlace& place) noexcept;

  void word(std::uint32_t offset, std::uint32_t value) noexcept {
    JournalEntry* const to = next_;
    publish(*to, halves(offset, value), word_half_);
    pass(to + 1);
  }
  /// A word that somebody else wrote, who has no journal.
  void word_of(std::uint32_t node, std::uint32_t offset, std::uint32_t value) noexcept {
    append(EntryKind::Word, offset, value, node + 1);
  }
  /// @param count  of the record's write
  void group(std::uint32_t base, std::span<const std::uint32_t> words,
             std::uint32_t count) noexcept {
    const std::size_t entries = group_entries(words.size());
    JournalEntry* const to = next_;
    if (entries >= static_cast<std::size_t>(stop_ - to))
      return group_over_a_hint(base, words, count);
    const std::uint32_t data = tag(EntryKind::Data);
    publish(*to, base, static_cast<std::uint32_t>(words.size()), count, tag(EntryKind::Group));
    publish_words(to + 1, words, data);
    next_ = to + entries;
  }
  void time(std::uint64_t nanoseconds) noexcept {
    append(EntryKind::Time, low_half(nanoseconds), high_half(nanoseconds), 0);
  }

 private:
  void append(EntryKind kind, std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept {
    publish(*next_, a, b, c, tag(kind));
    pass(next_ + 1);
  }
  [[nodiscard]] std::uint32_t tag(EntryKind kind) const noexcept {
    return lap_tag_ | static_cast<std::uint32_t>(kind);
  }
  /// All entries up to here are published, and no hint was passed since the last.
  void pass(JournalEntry* next) noexcept {
    next_ = next;
    if (next == stop_) [[unlikely]]
      turn();
  }
  void group_over_a_hint(std::uint32_t base, std::span<const std::uint32_t> words,
                         std::uint32_t count) noexcept;
  /// Leaves a hint, and begins the next lap where this one ends.
  void turn() noexcept;
  void begin_at(std::uint64_t position) noexcept;
  [[nodiscard]] std::uint64_t position() const noexcept {
    return lap_begin_ + static_cast<std::uint64_t>(next_ - place_.entries);
  }

  JournalEntry* next_ = nullptr;
  JournalEntry* stop_ = nullptr;  ///< where the next hint is due
  std::uint64_t word_half_ = 0;   ///< the half of a word's entry that is the same for a lap
  std::uint32_t lap_tag_ = 0;
  std::uint64_t lap_begin_ = 0;  ///< position of the lap's first entry
  JournalPlace place_;
};

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
//
// A writer's journal: everything it wrote, in order, in shared memory. One writer, any number of
// readers, none of which it knows of. An entry is published by one 16-byte store, and says itself
// whether it is there: its lap is that of its position.
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
  Group = 2,  ///< a: offset of the first word, b: longwords; its words follow as Data
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
inline constexpr std::uint32_t kWordsPerEntry = 3;  ///< of a group
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

[[nodiscard]] constexpr std::uint64_t journal_bytes(std::uint32_t bits) noexcept {
  return sizeof(JournalHead) + (sizeof(JournalEntry) << bits);
}

inline std::uint64_t halves(std::uint32_t low, std::uint32_t high) noexcept {
  return static_cast<std::uint64_t>(high) << 32U | low;
}

/// Publishes an entry whole. Everything the thread stored before is visible to whoever sees it.
inline void publish(JournalEntry& to, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                    std::uint32_t tag) noexcept {
#ifdef RTHS_ONE_STORE
  // x86-64 with AVX stores aligned 16 bytes at once, and no store before another.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  _mm_store_si128(reinterpret_cast<__m128i*>(&to),
                  _mm_set_epi64x(static_cast<std::int64_t>(halves(c, tag)),
                                 static_cast<std::int64_t>(halves(a, b))));
  std::atomic_signal_fence(std::memory_order_seq_cst);
#else
  // In three: void, contents, valid. Whoever sees new contents also sees that the old tag is gone.
  auto* words = reinterpret_cast<std::uint32_t*>(&to);
  std::atomic_ref{words[3]}.store(0, std::memory_order_relaxed);
  std::atomic_ref{words[0]}.store(a, std::memory_order_release);
  std::atomic_ref{words[1]}.store(b, std::memory_order_release);
  std::atomic_ref{words[2]}.store(c, std::memory_order_release);
  std::atomic_ref{words[3]}.store(tag, std::memory_order_release);
#endif
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

/// The entry in a slot as one write left it; its tag is 0 if there is none, or one is just coming.
inline JournalEntry fetch(const JournalEntry& from) noexcept {
#ifdef RTHS_ONE_STORE
  std::atomic_signal_fence(std::memory_order_seq_cst);
  const __m128i bits = _mm_load_si128(reinterpret_cast<const __m128i*>(&from));
  std::atomic_signal_fence(std::memory_order_seq_cst);
  JournalEntry entry;
  _mm_store_si128(reinterpret_cast<__m128i*>(&entry), bits);
  return entry;
#else
  auto* words = const_cast<std::uint32_t*>(reinterpret_cast<const std::uint32_t*>(&from));
  JournalEntry entry;
  entry.tag = std::atomic_ref{words[3]}.load(std::memory_order_acquire);
  entry.a = std::atomic_ref{words[0]}.load(std::memory_order_acquire);
  entry.b = std::atomic_ref{words[1]}.load(std::memory_order_acquire);
  entry.c = std::atomic_ref{words[2]}.load(std::memory_order_acquire);
  if (std::atomic_ref{words[3]}.load(std::memory_order_relaxed) != entry.tag) entry.tag = 0;
  return entry;
#endif
}

enum class Fetched { Entry, NotYet, Gone };

/// Reads the entry at a position. Gone: the writer has lapped it.
inline Fetched fetch_at(const JournalPlace& place, std::uint64_t position,
                        JournalEntry& entry) noexcept {
  entry = fetch(place.slot(position));
  const std::uint32_t expected = place.lap(position);
  const std::uint32_t found = entry.tag >> 4U;
  if (found == expected) return Fetched::Entry;
  if (entry.tag == 0) return Fetched::NotYet;
  // Of two laps less than half of all laps apart, which one is ahead.
  const std::uint32_t ahead = (found - expected) & ((1U << kLapBits) - 1);
  return ahead < (1U << (kLapBits - 1)) ? Fetched::Gone : Fetched::NotYet;
}

/// The first position not written yet, or one close behind it while the writer is at work.
[[nodiscard]] std::uint64_t end_of(const JournalPlace& place) noexcept;

/// The oldest position that is still there, or shortly was.
[[nodiscard]] std::uint64_t begin_of(const JournalPlace& place) noexcept;

/// Publishes words of a group in as many entries as they take.
inline void publish_words(JournalEntry* to, std::span<const std::uint32_t> words,
                          std::uint32_t tag) noexcept {
  std::size_t i = 0;
  for (; i + kWordsPerEntry < words.size(); i += kWordsPerEntry)
    publish_words(*to++, &words[i], tag);
  const auto word = [&](std::size_t at) { return at < words.size() ? words[at] : 0; };
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

  void word(std::uint32_t offset, std::uint32_t value, std::uint32_t on_behalf = 0) noexcept {
    append(EntryKind::Word, offset, value, on_behalf);
  }
  void group(std::uint32_t base, std::span<const std::uint32_t> words) noexcept {
    const auto entries = static_cast<std::uint32_t>(group_entries(words.size()));
    const std::uint32_t index = index_;
    if (index % kHintEvery + entries >= kHintEvery) return group_over_a_hint(base, words);
    JournalEntry* const to = place_.entries + index;
    const std::uint32_t data = tag(EntryKind::Data);
    publish(*to, base, static_cast<std::uint32_t>(words.size()), 0, tag(EntryKind::Group));
    publish_words(to + 1, words, data);
    index_ = index + entries;
  }
  void time(std::uint64_t nanoseconds) noexcept {
    append(EntryKind::Time, static_cast<std::uint32_t>(nanoseconds),
           static_cast<std::uint32_t>(nanoseconds >> 32U), 0);
  }

 private:
  // What is read again after a store may be taken for changed by it: hence the copies.
  void append(EntryKind kind, std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept {
    const std::uint32_t index = index_;
    publish(place_.entries[index], a, b, c, tag(kind));
    pass(index + 1);
  }
  [[nodiscard]] std::uint32_t tag(EntryKind kind) const noexcept {
    return lap_tag_ | static_cast<std::uint32_t>(kind);
  }
  /// All entries up to here are published, and no hint was passed since the last.
  void pass(std::uint32_t index) noexcept {
    index_ = index;
    if (index % kHintEvery == 0) [[unlikely]]
      turn();
  }
  void group_over_a_hint(std::uint32_t base, std::span<const std::uint32_t> words) noexcept;
  /// Leaves a hint, and begins the next lap where this one ends.
  void turn() noexcept;
  [[nodiscard]] std::uint64_t position() const noexcept { return lap_begin_ + index_; }

  JournalPlace place_;
  std::uint32_t index_ = 0;      ///< of the next entry
  std::uint32_t lap_tag_ = 0;    ///< of this lap
  std::uint64_t lap_begin_ = 0;  ///< position of its first entry
};

/// Reads a group that was journalled at a position. False if it is no longer, or not yet, there.
[[nodiscard]] bool read_journalled_group(const JournalPlace& place, std::uint64_t position,
                                         std::uint32_t base,
                                         std::span<std::uint32_t> words) noexcept;

}  // namespace rths::broker

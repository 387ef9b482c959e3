// SPDX-License-Identifier: Apache-2.0
//
// Reads journals; detail/journal_writer.hpp writes them.
#pragma once

#include <cstdint>
#include <span>

#include <rths/broker/detail/journal_writer.hpp>

namespace rths::broker {

[[nodiscard]] constexpr std::uint64_t journal_bytes(std::uint32_t bits) noexcept {
  return sizeof(JournalHead) + (sizeof(JournalEntry) << bits);
}

/// Reads an entry atomically; the tag is 0 if there is none or one is being published.
inline JournalEntry fetch(const JournalEntry& from) noexcept {
#ifdef RTHS_ONE_STORE
  std::atomic_signal_fence(std::memory_order_seq_cst);
  const __m128i bits = _mm_load_si128(reinterpret_cast<const __m128i*>(&from));
  std::atomic_signal_fence(std::memory_order_seq_cst);
  // Extracts the halves in registers: a copy through memory would be slower.
  const auto ab = static_cast<std::uint64_t>(_mm_cvtsi128_si64(bits));
  const auto ct = static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_unpackhi_epi64(bits, bits)));
  return {low_half(ab), high_half(ab), low_half(ct), high_half(ct)};
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

/// Reads the entry at a position. Gone: the writer has overwritten it.
inline Fetched fetch_at(const JournalView& journal, std::uint64_t position,
                        JournalEntry& entry) noexcept {
  entry = fetch(journal.slot(position));
  const std::uint32_t expected = journal.lap(position);
  const std::uint32_t found = entry.tag >> 4U;
  if (found == expected) return Fetched::Entry;
  if (entry.tag == 0) return Fetched::NotYet;
  // Laps wrap: a difference below half of all laps means that the entry found is newer.
  const std::uint32_t ahead = (found - expected) & ((1U << kLapBits) - 1);
  return ahead < (1U << (kLapBits - 1)) ? Fetched::Gone : Fetched::NotYet;
}

/// By which the writes before an entry of kind Time were late.
inline Duration late_of(const JournalEntry& entry) noexcept { return Duration{entry.c}; }

/// The first position that is not written yet, or shortly before it while the writer is running.
[[nodiscard]] std::uint64_t end_of(const JournalView& journal) noexcept;

/// The oldest position that is not overwritten, or shortly before it while the writer is running.
[[nodiscard]] std::uint64_t begin_of(const JournalView& journal) noexcept;

/// Reads the group at a position. False if it was overwritten or is not complete.
[[nodiscard]] bool read_journalled_group(const JournalView& journal, std::uint64_t position,
                                         std::uint32_t base,
                                         std::span<std::uint32_t> words) noexcept;

}  // namespace rths::broker

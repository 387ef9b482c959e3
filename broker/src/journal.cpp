// SPDX-License-Identifier: Apache-2.0
#include "journal.hpp"

#include <algorithm>

#include "record.hpp"

namespace rths::broker {
namespace {

constexpr int kLooks = 4;  // at a hint that a running writer moves meanwhile

}  // namespace

std::uint64_t end_of(const JournalPlace& place) noexcept {
  std::uint64_t position = 0;
  for (int look = 0; look < kLooks; ++look) {
    position = std::atomic_ref{place.head->hint}.load(std::memory_order_acquire);
    JournalEntry entry;
    Fetched fetched = Fetched::Entry;
    // Two hints apart is where the end must be; beyond that the writer is running away from us.
    for (std::uint64_t i = 0; i < 2 * kHintEvery && fetched == Fetched::Entry; ++i) {
      fetched = fetch_at(place, position, entry);
      if (fetched == Fetched::Entry) ++position;
    }
    if (fetched == Fetched::NotYet) break;
  }
  return position;
}

std::uint64_t begin_of(const JournalPlace& place) noexcept {
  const std::uint64_t end = end_of(place);
  const std::uint64_t length = std::uint64_t{1} << place.bits;
  return end > length ? end - length : 0;
}

JournalWriter::JournalWriter(const JournalPlace& place) noexcept : place_{place} {
  begin_at(end_of(place));
  // A predecessor may have died before it left one; with two such the end would be out of sight.
  std::atomic_ref{place_.head->hint}.store(position(), std::memory_order_release);
}

void JournalWriter::begin_at(std::uint64_t position) noexcept {
  const std::uint64_t index = position & ((std::uint64_t{1} << place_.bits) - 1);
  lap_begin_ = position - index;
  next_ = place_.entries + index;
  stop_ = place_.entries + (index / kHintEvery + 1) * kHintEvery;
  lap_tag_ = place_.lap(position) << 4U;
  word_half_ = halves(0, tag(EntryKind::Word));
}

void JournalWriter::turn() noexcept {
  std::atomic_ref{place_.head->hint}.store(position(), std::memory_order_release);
  begin_at(position());
  // What comes after the next hint: long since read by all who will, and in nobody's cache.
  const JournalEntry& ahead = place_.slot(position() + kHintEvery);
  detail::ask_for_lines(reinterpret_cast<const std::uint32_t*>(&ahead), kHintEvery * sizeof ahead);
}

void JournalWriter::group_over_a_hint(std::uint32_t base, std::span<const std::uint32_t> words,
                                      std::uint32_t count) noexcept {
  append(EntryKind::Group, base, static_cast<std::uint32_t>(words.size()), count);
  while (!words.empty()) {
    const auto room = static_cast<std::size_t>(stop_ - next_) * kWordsPerEntry;
    const auto part = words.first(std::min(room, words.size()));
    publish_words(next_, part, tag(EntryKind::Data));
    pass(next_ + entries_of(part.size()));
    words = words.subspan(part.size());
  }
}

bool read_journalled_group(const JournalPlace& place, std::uint64_t position, std::uint32_t base,
                           std::span<std::uint32_t> words) noexcept {
  JournalEntry entry;
  if (fetch_at(place, position, entry) != Fetched::Entry || entry.kind() != EntryKind::Group ||
      entry.a != base || entry.b != words.size())
    return false;
  for (std::size_t i = 0; i < words.size(); i += kWordsPerEntry) {
    if (fetch_at(place, ++position, entry) != Fetched::Entry || entry.kind() != EntryKind::Data)
      return false;
    const std::uint32_t three[] = {entry.a, entry.b, entry.c};
    std::copy_n(three, std::min<std::size_t>(kWordsPerEntry, words.size() - i),
                words.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return true;
}

}  // namespace rths::broker

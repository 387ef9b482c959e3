// SPDX-License-Identifier: Apache-2.0
#include "journal.hpp"

#include <algorithm>

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
  const std::uint64_t end = end_of(place);
  lap_begin_ = end >> place.bits << place.bits;
  index_ = static_cast<std::uint32_t>(end - lap_begin_);
  lap_tag_ = place.lap(end) << 4U;
  // A predecessor may have died before it left one; with two such the end would be out of sight.
  std::atomic_ref{place_.head->hint}.store(end, std::memory_order_release);
}

void JournalWriter::turn() noexcept {
  std::atomic_ref{place_.head->hint}.store(position(), std::memory_order_release);
  if (index_ >> place_.bits == 0) return;
  lap_begin_ = position();
  index_ = 0;
  lap_tag_ = place_.lap(lap_begin_) << 4U;
}

void JournalWriter::group_over_a_hint(std::uint32_t base,
                                      std::span<const std::uint32_t> words) noexcept {
  append(EntryKind::Group, base, static_cast<std::uint32_t>(words.size()), 0);
  while (!words.empty()) {
    const std::size_t room = (kHintEvery - index_ % kHintEvery) * kWordsPerEntry;
    const auto part = words.first(std::min(room, words.size()));
    publish_words(place_.entries + index_, part, tag(EntryKind::Data));
    pass(index_ + static_cast<std::uint32_t>(entries_of(part.size())));
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

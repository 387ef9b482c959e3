// SPDX-License-Identifier: Apache-2.0
#include "journal.hpp"

#include <algorithm>

#include "record.hpp"

namespace rths::broker {
namespace {

constexpr int kHintAttempts = 4;  // a running writer may move the hint meanwhile

}  // namespace

std::uint64_t end_of(const JournalView& journal) noexcept {
  std::uint64_t position = 0;
  for (int attempt = 0; attempt < kHintAttempts; ++attempt) {
    position = std::atomic_ref{journal.head->hint}.load(std::memory_order_acquire);
    JournalEntry entry;
    Fetched fetched = Fetched::Entry;
    // The end is within two hint intervals, unless the writer moved on: then it tries again.
    for (std::uint64_t i = 0; i < 2 * kHintEvery && fetched == Fetched::Entry; ++i) {
      fetched = fetch_at(journal, position, entry);
      if (fetched == Fetched::Entry) ++position;
    }
    if (fetched == Fetched::NotYet) break;
  }
  return position;
}

std::uint64_t begin_of(const JournalView& journal) noexcept {
  const std::uint64_t end = end_of(journal);
  const std::uint64_t length = std::uint64_t{1} << journal.bits;
  return end > length ? end - length : 0;
}

JournalWriter::JournalWriter(const JournalView& journal) noexcept : journal_{journal} {
  begin_at(end_of(journal));
  // A predecessor may have died before its hint; after two such the end would not be found.
  std::atomic_ref{journal_.head->hint}.store(position(), std::memory_order_release);
}

void JournalWriter::begin_at(std::uint64_t position) noexcept {
  const std::uint64_t index = position & ((std::uint64_t{1} << journal_.bits) - 1);
  lap_begin_ = position - index;
  next_ = journal_.entries + index;
  stop_ = journal_.entries + (index / kHintEvery + 1) * kHintEvery;
  lap_tag_ = journal_.lap(position) << 4U;
  word_half_ = halves(0, tag(EntryKind::Word));
}

void JournalWriter::publish_hint() noexcept {
  std::atomic_ref{journal_.head->hint}.store(position(), std::memory_order_release);
  begin_at(position());
  // Prefetches the entries behind the next hint, which are old and in no cache.
  const JournalEntry& ahead = journal_.slot(position() + kHintEvery);
  detail::prefetch_lines(reinterpret_cast<const std::uint32_t*>(&ahead), kHintEvery * sizeof ahead);
}

void JournalWriter::group_across_hint(std::uint32_t base, std::span<const std::uint32_t> words,
                                      std::uint32_t count) noexcept {
  append(EntryKind::Group, base, static_cast<std::uint32_t>(words.size()), count);
  while (!words.empty()) {
    const auto capacity = static_cast<std::size_t>(stop_ - next_) * kWordsPerEntry;
    const auto chunk = words.first(std::min(capacity, words.size()));
    publish_words(next_, chunk, tag(EntryKind::Data));
    advance_to(next_ + entries_of(chunk.size()));
    words = words.subspan(chunk.size());
  }
}

bool read_journalled_group(const JournalView& journal, std::uint64_t position, std::uint32_t base,
                           std::span<std::uint32_t> words) noexcept {
  JournalEntry entry;
  if (fetch_at(journal, position, entry) != Fetched::Entry || entry.kind() != EntryKind::Group ||
      entry.a != base || entry.b != words.size())
    return false;
  for (std::size_t i = 0; i < words.size(); i += kWordsPerEntry) {
    if (fetch_at(journal, ++position, entry) != Fetched::Entry || entry.kind() != EntryKind::Data)
      return false;
    const std::uint32_t three[] = {entry.a, entry.b, entry.c};
    std::copy_n(three, std::min<std::size_t>(kWordsPerEntry, words.size() - i),
                words.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return true;
}

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
#include "repair.hpp"

#include <atomic>
#include <vector>

#include "journal.hpp"
#include "record.hpp"

namespace rths::broker {
namespace {

std::atomic_ref<std::uint32_t> journalled(const GroupView& group) {
  return std::atomic_ref{*group.journalled};
}

// True if the writer died after it journalled the group and before it marked it as journalled: then
// the group is the journal's last entry.
bool is_last_entry(const JournalView& journal, const GroupView& group, std::uint32_t count) {
  const std::uint64_t end = end_of(journal);
  const std::uint64_t length = group_entries(group.longwords);
  JournalEntry entry;
  return end >= length && fetch_at(journal, end - length, entry) == Fetched::Entry &&
         entry.kind() == EntryKind::Group && entry.a == group.base && entry.c == count;
}

}  // namespace

// A writer writes record, memory and journal in this order.
bool repair_group(const GroupView& group, const JournalView& journal) {
  std::uint32_t* record = group.record;
  if (!is_enabled(record)) return false;
  std::vector<std::uint32_t> words(group.longwords);
  if (is_torn(record, group.longwords)) {
    // Restores the previous write, which was journalled. Marks it first: this process may die too.
    const std::uint32_t count = count_of(record);
    journalled(group).store(next_count(count), std::memory_order_release);
    load_words(words, group.words);
    write_record(record, words, count);
    return false;
  }
  if (!read_record(record, words)) return false;
  store_words(group.words, words);
  const std::uint32_t count = count_of(record);
  if (journalled(group).load() != count && is_last_entry(journal, group, count))
    journalled(group).store(count, std::memory_order_release);
  return journalled(group).load() != count;
}

void journal_repaired_group(const GroupView& group, JournalWriter& journal) {
  std::uint32_t* record = group.record;
  std::vector<std::uint32_t> words(group.longwords);
  if (!read_record(record, words)) return;
  journal.group(group.base, words, count_of(record));
  journalled(group).store(count_of(record), std::memory_order_release);
}

}  // namespace rths::broker

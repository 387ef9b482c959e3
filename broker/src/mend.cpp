// SPDX-License-Identifier: Apache-2.0
#include "mend.hpp"

#include <atomic>
#include <vector>

#include "record.hpp"

namespace rths::broker {
namespace {

// A writer may have died between its journal and the mark that says so: what it journalled whole
// after the last marked write counts.
bool read_newest(const JournalPlace& journal, std::uint64_t marked, std::uint32_t base,
                 std::vector<std::uint32_t>& words) {
  if (!read_journalled_group(journal, marked, base, words)) return false;
  std::vector<std::uint32_t> later(words.size());
  JournalEntry entry;
  for (std::uint64_t at = marked + 1; fetch_at(journal, at, entry) == Fetched::Entry; ++at)
    if (read_journalled_group(journal, at, base, later)) words = later;
  return true;
}

bool memory_holds(const std::uint32_t* memory, const std::vector<std::uint32_t>& words) {
  std::vector<std::uint32_t> found(words.size());
  load_words(found, memory);
  return found == words;
}

}  // namespace

// A writer goes through journal, record and memory in this order, so the journal is never behind.
bool mend_group(Segment& segment, Group& group, const JournalPlace& journal) {
  const std::uint64_t journalled = std::atomic_ref{group.journalled}.load();
  if (journalled == 0) return false;
  std::vector<std::uint32_t> words(group.longwords);
  if (!read_newest(journal, journalled - 1, group.base, words)) return false;
  std::uint32_t* record = segment.record(group);
  std::uint32_t* memory = segment.words() + group.base;
  std::vector<std::uint32_t> recorded(group.longwords);
  const bool torn = is_torn(record, group.longwords);
  if (!torn && read_record(record, recorded) && recorded == words && memory_holds(memory, words))
    return false;
  write_record(record, words);
  store_words(memory, words);
  return true;
}

}  // namespace rths::broker

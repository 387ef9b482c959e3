// SPDX-License-Identifier: Apache-2.0
#include "mend.hpp"

#include <atomic>
#include <vector>

#include "record.hpp"

namespace rths::broker {
namespace {

// A writer may have died between its journal and the mark that says so: then the journal ends with
// what it wrote. Otherwise the marked write is the newest.
/// @param mark  position of the marked write plus 1, 0: none
/// @returns the same of the newest, 0: none, or no longer there
std::uint64_t read_newest(const JournalPlace& journal, std::uint64_t mark, std::uint32_t base,
                          std::vector<std::uint32_t>& words) {
  const std::uint64_t end = end_of(journal);
  const std::uint64_t length = group_entries(words.size());
  if (end >= mark + length && read_journalled_group(journal, end - length, base, words))
    return end - length + 1;
  return mark != 0 && read_journalled_group(journal, mark - 1, base, words) ? mark : 0;
}

bool memory_holds(const std::uint32_t* memory, const std::vector<std::uint32_t>& words) {
  std::vector<std::uint32_t> found(words.size());
  load_words(found, memory);
  return found == words;
}

}  // namespace

// A writer goes through journal, record and memory in this order, so the journal is never behind.
bool mend_group(Segment& segment, Group& group, const JournalPlace& journal) {
  auto journalled = std::atomic_ref{group.journalled};
  std::vector<std::uint32_t> words(group.longwords);
  const std::uint64_t newest = read_newest(journal, journalled.load(), group.base, words);
  if (newest == 0) return false;
  std::uint32_t* record = segment.record(group);
  std::uint32_t* memory = segment.words() + group.base;
  std::vector<std::uint32_t> recorded(group.longwords);
  const bool torn = is_torn(record, group.longwords);
  if (!torn && read_record(record, recorded) && recorded == words && memory_holds(memory, words))
    return false;
  journalled.store(newest, std::memory_order_release);  // or readers could fall back behind it
  write_record(record, words);
  store_words(memory, words);
  return true;
}

}  // namespace rths::broker

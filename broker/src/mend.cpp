// SPDX-License-Identifier: Apache-2.0
#include "mend.hpp"

#include <atomic>
#include <vector>

#include "record.hpp"

namespace rths::broker {

// A writer goes through record, memory and journal in this order.
void mend_group(Segment& segment, Group& group, JournalWriter& journal) {
  std::uint32_t* record = segment.record(group);
  std::uint32_t* memory = segment.words() + group.base;
  if (!is_kept(record)) return;
  std::vector<std::uint32_t> words(group.longwords);
  if (is_torn(record, group.longwords)) {
    load_words(words, memory);
    write_record(record, words, count_of(record));
  } else if (read_record(record, words)) {
    store_words(memory, words);
  }
  auto journalled = std::atomic_ref{group.journalled};
  if (journalled.load() == count_of(record)) return;
  journal.group(group.base, words);
  journalled.store(count_of(record), std::memory_order_release);
}

}  // namespace rths::broker

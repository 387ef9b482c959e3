// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/follow.hpp>

#include "segment.hpp"

namespace rths::broker {
namespace {

TimePoint time_in(const JournalEntry& entry) {
  return TimePoint{static_cast<std::int64_t>(halves(entry.a, entry.b))};
}

// Searches a journal from its newest to its oldest entry for the last write of a word and the time
// before it.
class Search {
 public:
  Search(const JournalView& journal, LongwordOffset offset) : journal_{journal}, offset_{offset} {}

  void run(LastWrite& found) {
    const std::uint64_t end = end_of(journal_);
    const std::uint64_t begin = begin_of(journal_);
    for (std::uint64_t position = end; position > begin; --position) {
      JournalEntry entry;
      if (fetch_at(journal_, position - 1, entry) != Fetched::Entry) return;
      if (entry.kind() == EntryKind::Time) {
        (found.value ? found.not_before : found.not_after) = time_in(entry);
        if (found.value) return;
      } else if (!found.value) {
        found.value = value_in(entry, position - 1);
      }
    }
  }

 private:
  [[nodiscard]] std::optional<std::uint32_t> value_in(const JournalEntry& entry,
                                                      std::uint64_t position) const {
    if (entry.kind() == EntryKind::Word && entry.a == offset_.value()) return entry.b;
    const bool inside = entry.kind() == EntryKind::Group && offset_.value() >= entry.a &&
                        offset_.value() < entry.a + entry.b;
    if (!inside) return std::nullopt;
    std::vector<std::uint32_t> words(entry.b);
    if (!read_journalled_group(journal_, position, entry.a, words)) return std::nullopt;
    return words[offset_.value() - entry.a];
  }

  JournalView journal_;
  LongwordOffset offset_;
};

}  // namespace

LastWrite Ring::last_write(LongwordOffset offset) {
  LastWrite found;
  const auto* partition = map_->partition_at(offset);
  if (partition == nullptr) return found;
  found.node = partition->node;
  Search{segment_->journal(node_index(*map_, map_->node(partition->node))), offset}.run(found);
  return found;
}

}  // namespace rths::broker

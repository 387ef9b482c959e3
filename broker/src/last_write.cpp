// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/follow.hpp>

#include "segment.hpp"

namespace rths::broker {
namespace {

// Zero, which means unknown, if it is not a time of this host.
TimePoint time_in(const JournalEntry& entry) {
  const TimePoint time{static_cast<std::int64_t>(halves(entry.a, entry.b))};
  return time > TimePoint{0} && time <= WallClock{}.now() ? time : TimePoint{0};
}

// Searches a journal from its newest to its oldest entry for the last write of a word and the time
// before it.
class Search {
 public:
  /// @param partition  of the word
  Search(const JournalView& journal, const memmap::Partition& partition, LongwordOffset offset)
      : journal_{journal}, partition_{partition}, offset_{offset} {
    if (partition.tear_group) group_.resize(partition.longwords);
  }

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
                                                      std::uint64_t position) {
    if (entry.kind() == EntryKind::Word && entry.a == offset_.value()) return entry.b;
    const std::uint32_t base = partition_.base.value();
    if (entry.kind() != EntryKind::Group || entry.a != base || group_.empty() ||
        !read_journalled_group(journal_, position, base, group_))
      return std::nullopt;
    return group_[offset_.value() - base];
  }

  JournalView journal_;
  const memmap::Partition& partition_;
  LongwordOffset offset_;
  std::vector<std::uint32_t> group_;
};

}  // namespace

LastWrite Ring::last_write(LongwordOffset offset) {
  LastWrite found;
  const auto* partition = map_->partition_at(offset);
  if (partition == nullptr) return found;
  found.node = partition->node;
  Search{segment_->journal(node_index(*map_, map_->node(partition->node))), *partition, offset}.run(
      found);
  return found;
}

}  // namespace rths::broker

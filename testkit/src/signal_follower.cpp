// SPDX-License-Identifier: Apache-2.0
#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

SignalFollower::SignalFollower(std::shared_ptr<SignalRing> ring,
                               const std::vector<std::string>& signals)
    : ring_{std::move(ring)} {
  if (signals.empty()) throw Error{"expected at least one signal to follow"};
  std::vector<broker::LongwordRange> words;
  for (const auto& signal : signals) {
    entries_.push_back(&ring_->entry(signal));
    words.push_back({entries_.back()->signal->offset, 1});
  }
  waiter_.emplace(ring_->ring().wait_for(words));
}

Change SignalFollower::change_of(const broker::Write& write) {
  Change change{ring_->map().node_name(write.writer), {}};
  const std::uint32_t begin = write.offset.value();
  for (const auto* const entry : entries_) {
    const std::uint32_t offset = entry->signal->offset.value();
    if (offset < begin) continue;
    if (write.group.empty() ? offset != begin : offset - begin >= write.group.size()) continue;
    const std::uint32_t word = write.group.empty() ? write.value : write.group[offset - begin];
    change.values.emplace_back(entry->name, ring_->codec(*entry).decode(word));
  }
  return change;
}

}  // namespace rths::testkit

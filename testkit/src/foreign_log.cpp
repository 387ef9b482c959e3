// SPDX-License-Identifier: Apache-2.0
#include "foreign_log.hpp"

#include <fmt/format.h>

#include <rths/broker/watch_text.hpp>

namespace rths::testkit {

void ForeignLog::look(broker::Watch& watch) {
  const auto stores = watch.look();
  has_suspicion_.store(watch.has_suspicion());
  for (const auto& store : stores) {
    if (store.allowed) continue;
    const std::lock_guard lock{mutex_};
    if (!first_.empty()) return;
    const std::string expected = store.owner.empty()
                                     ? "no store, because no node owns the word"
                                     : fmt::format("stores by its owner {} alone", store.owner);
    first_ = fmt::format("{}: stored as {} by {} at {:.3f} s, expected {}",
                         broker::word_name(map_, store.offset),
                         broker::word_value(map_, store.offset, store.value),
                         broker::writers_of(store), to_seconds(store.seen - begun_), expected);
  }
}

std::string ForeignLog::first() const {
  const std::lock_guard lock{mutex_};
  return first_;
}

}  // namespace rths::testkit

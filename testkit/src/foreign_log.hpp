// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <mutex>
#include <string>

#include <rths/broker/watch.hpp>

namespace rths::testkit {

/// The first store that was not made by the word's owner, among those that a watch finds. One
/// thread looks, others read.
class ForeignLog {
 public:
  /// @param map  kept by reference   @param begun  time 0 of the text
  ForeignLog(const memmap::Map& map, TimePoint begun) : map_{map}, begun_{begun} {}

  /// Compares all words once.
  void look(broker::Watch& watch);
  /// As one line; empty: none was found.
  [[nodiscard]] std::string first() const;
  /// Whether a store is still to be judged.
  [[nodiscard]] bool has_suspicion() const { return has_suspicion_.load(); }

 private:
  const memmap::Map& map_;
  TimePoint begun_;
  mutable std::mutex mutex_;  ///< of the next one
  std::string first_;
  std::atomic<bool> has_suspicion_{false};
};

}  // namespace rths::testkit

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <thread>
#include <vector>

#include <rths/broker/watch.hpp>
#include <rths/recording/foreign_stores.hpp>

namespace rths::launch {

/// Looks in a run, every two milliseconds, for words that another process than their owner has
/// stored.
class OwnershipWatch {
 public:
  /// Begins. @param ring  kept by reference; before its nodes join
  explicit OwnershipWatch(broker::Ring& ring);
  ~OwnershipWatch() { end(); }
  OwnershipWatch(const OwnershipWatch&) = delete;
  OwnershipWatch& operator=(const OwnershipWatch&) = delete;

  /// Ends. @returns what was found, by time   @param epoch  time 0 of the run
  [[nodiscard]] std::vector<recording::ForeignStore> finish(TimePoint epoch);

 private:
  struct Found {
    broker::PlainStore first;
    std::size_t count = 0;
  };
  void run();
  void end();

  const memmap::Map& map_;
  broker::Watch watch_;
  std::map<std::uint32_t, Found> found_;  ///< by longword; of the thread until it has ended
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace rths::launch

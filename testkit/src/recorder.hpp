// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <rths/broker/watch.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

/// A store that was not made by the word's owner, as one line.
[[nodiscard]] std::string foreign_store_text(const memmap::Map& map,
                                             const broker::PlainStore& store, TimePoint begun);

/// Keeps every change of a ring in memory, in a thread of its own, and journals the stores of
/// programs for the cards, so that others can follow them. Finds stores into words of others.
class Recorder {
 public:
  explicit Recorder(const std::string& ring);
  ~Recorder() { end(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// The first store that was not made by the word's owner, as one line; empty: none was found.
  [[nodiscard]] std::string foreign_store() const;
  /// Whether the thread still has to judge a store.
  [[nodiscard]] bool has_suspicion() const { return has_suspicion_.load(); }
  /// Ends the thread. Twice has no effect.
  void end();
  /// Writes all signals [SI] to a recording. Changes of different signals within a millisecond
  /// share a row. @throws Error if the file cannot be written
  void write(const std::filesystem::path& file);

 private:
  struct Entry {
    Duration time;  ///< since the begin
    std::uint32_t signal;
    std::uint32_t word;
  };
  void record();
  void look(broker::Watch& watch);
  void take(const broker::Write& write);

  std::shared_ptr<SignalRing> ring_;
  broker::Node observer_;
  broker::Waiter waiter_;
  std::vector<std::uint32_t> signals_;  ///< by offset; kNone: no signal begins there
  std::vector<double> first_;           ///< values at the begin [SI]
  std::vector<Entry> entries_;
  std::uint64_t missing_ = 0;  ///< writes that were lost, or for which there was no room
  TimePoint begun_;
  mutable std::mutex mutex_;  ///< of the next one
  std::string foreign_store_;
  std::atomic<bool> ends_{false}, has_suspicion_{false};
  std::thread thread_;
};

}  // namespace rths::testkit

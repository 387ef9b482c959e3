// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/monitor/server.hpp>

namespace rths::test {

/// A small test on a ring of its own: a machine and a controller, which write 1000 times per second
/// from a thread of this process. The command is a sine of 10 mm and 1 Hz; the machine follows it
/// 0.1 mm behind, and doubles the force if its parameter says so.
class Laboratory {
 public:
  /// @param words  further ones of the machine, "extra.0" to "extra.<words − 1>"
  explicit Laboratory(const std::string& ring, int words = 0);
  ~Laboratory();
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  /// The safety layer trips in the next millisecond.
  void trip() { trips_.store(true); }
  /// Steps until now.
  [[nodiscard]] std::uint64_t steps() const { return steps_.load(); }
  /// Times that the writes of each step took since the last call, at most of 100 s [s].
  [[nodiscard]] std::vector<double> durations();

 private:
  void run();

  broker::Ring ring_;
  std::string name_;
  int words_;
  std::atomic<bool> ends_{false}, trips_{false};
  std::atomic<std::uint64_t> steps_{0};
  std::mutex mutex_;  ///< of the durations
  std::vector<double> durations_;
  std::thread thread_;
};

/// A page of a ring, with the words of the SRMD and a short history.
[[nodiscard]] inline monitor::ServerSettings settings_for(const std::string& ring) {
  monitor::ServerSettings settings;
  settings.ring = ring;
  settings.history_bytes = 1 << 22;
  settings.roles_of = [](const memmap::Map&) { return recording::read_roles({}); };
  return settings;
}

}  // namespace rths::test

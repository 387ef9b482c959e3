// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include <rths/adapters/adapter_runner.hpp>

#include "silence.hpp"

namespace rths::launch {

/// Start of a line with times of steps, from a node to the launcher.
inline constexpr const char* kTimesLine = "times ";

/// Sends the times of the steps of a node to the launcher, in microseconds.
void send_times(const adapters::StepTimes& times);
/// Adds the times of a line, without its start. Ignores what is not a number.
void read_times(const std::string& text, adapters::StepTimes& times);

/// The line that the launcher sends to its nodes several times per second.
inline constexpr const char* kAlive = "alive";

/// A node's link to its launcher: lines through standard input and output.
class LauncherLink {
 public:
  /// Waits for the next line, at most `longest`. Lines that only show that the launcher runs are
  /// left out.
  [[nodiscard]] std::optional<std::string> receive_line(Duration longest);
  /// Why the launcher cannot control this node: "the launcher vanished", when its end of the pipe
  /// is closed, or "the launcher is silent". Call it several times per second, after
  /// `receive_line`.
  [[nodiscard]] std::optional<std::string> find_trouble(TimePoint now);
  static void send_line(const std::string& line);
  /// Waits for the start of the run. @returns its time zero; empty if it does not start
  [[nodiscard]] std::optional<TimePoint> wait_for_go();

 private:
  [[nodiscard]] std::optional<std::string> take_line();

  std::string received_;
  std::uint64_t lines_ = 0;
  Silence silence_;
  bool vanished_ = false;
};

/// Ends the process if the launcher is lost while this object exists. Nothing moves yet, and the
/// setup can wait for other programs for a long time.
class SetupGuard {
 public:
  SetupGuard(LauncherLink& launcher, const std::string& node)
      : thread_{[this, &launcher, node] { run(launcher, node); }} {}
  ~SetupGuard() {
    done_.store(true, std::memory_order_relaxed);
    thread_.join();
  }
  SetupGuard(const SetupGuard&) = delete;
  SetupGuard& operator=(const SetupGuard&) = delete;

 private:
  void run(LauncherLink& launcher, const std::string& node);

  std::atomic<bool> done_{false};
  std::thread thread_;  ///< last, because it uses the member above
};

/// Period of the looks at the launcher and at the peers.
inline constexpr Duration kLookPeriod = std::chrono::milliseconds{20};

}  // namespace rths::launch

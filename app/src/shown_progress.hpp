// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <rths/session/progress.hpp>

namespace rths::app {

/// Shows on standard error which of several long steps of a command runs, and for how long: once
/// per second on a terminal, else every 30 s. Its end removes the line from a terminal.
class Steps {
 public:
  /// Where nothing is shown.
  enum class Silent { Nowhere, OffTerminals };
  explicit Steps(int count, Silent silent = Silent::Nowhere);
  ~Steps();
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  /// Begins the next step.
  void begin(const std::string& name);
  /// What the step is doing, with fits done of a total (0: not known); shown with the time left.
  void detail(const std::string& text, std::size_t done, std::size_t total);

 private:
  void show();
  [[nodiscard]] std::string line(double elapsed) const;

  int count_;
  bool is_silent_;
  std::string detail_;
  std::size_t done_ = 0, total_ = 0;
  std::chrono::steady_clock::time_point detail_begun_;
  int current_ = 0;
  bool ended_ = false;
  std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

/// Shows the progress of a session on standard error: notes, a bar for a test on a terminal, and
/// long steps.
class ShownProgress {
 public:
  explicit ShownProgress(Steps::Silent silent = Steps::Silent::Nowhere);
  [[nodiscard]] session::Progress& functions() { return functions_; }
  /// Removes what it shows from a terminal, before results are printed.
  void end();

 private:
  void show_bar(const launch::Progress& progress);
  void remove_bar();

  session::Progress functions_;
  std::optional<Steps> steps_;
  std::atomic<bool> has_bar_ = false;
};

}  // namespace rths::app

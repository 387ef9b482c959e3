// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace rths::app {

/// Shows on standard error which of several long steps of a command runs, and for how long: once
/// per second on a terminal, else every 30 s. Its end removes the line from a terminal.
class Steps {
 public:
  explicit Steps(int count);
  ~Steps();
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  /// Begins the next step.
  void begin(const std::string& name);

 private:
  void show();

  int count_;
  int current_ = 0;
  bool ended_ = false;
  std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace rths::app

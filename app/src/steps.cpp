// SPDX-License-Identifier: Apache-2.0
#include "steps.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

namespace rths::app {
namespace {

constexpr auto kTerminalPeriod = std::chrono::seconds{1};
constexpr auto kLogPeriod = std::chrono::seconds{30};

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace

Steps::Steps(int count) : count_{count}, thread_{[this] { show(); }} {}

Steps::~Steps() {
  {
    const std::lock_guard lock{mutex_};
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Steps::begin(const std::string& name) {
  {
    const std::lock_guard lock{mutex_};
    ++current_;
    name_ = name;
  }
  changed_.notify_all();
}

void Steps::show() {
  using Clock = std::chrono::steady_clock;
  const bool terminal = on_terminal();
  std::unique_lock lock{mutex_};
  int shown = 0;
  Clock::time_point begun = Clock::now();
  while (!ended_) {
    if (current_ == 0) {  // this thread may run before the first step begins
      changed_.wait(lock, [&] { return ended_ || current_ != 0; });
      continue;
    }
    const bool is_new = current_ != shown;
    if (is_new) begun = Clock::now();
    shown = current_;
    const auto elapsed = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - begun);
    const std::string line =
        fmt::format("step {} of {}: {}, {} s", current_, count_, name_, elapsed.count());
    if (terminal) fmt::print(stderr, "\r{}\033[K", line);
    if (!terminal && !is_new) fmt::print(stderr, "rths: {}\n", line);
    changed_.wait_for(lock, terminal ? kTerminalPeriod : kLogPeriod,
                      [&] { return ended_ || current_ != shown; });
  }
  if (terminal) fmt::print(stderr, "\r\033[K");
}

}  // namespace rths::app

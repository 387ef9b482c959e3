// SPDX-License-Identifier: Apache-2.0
#include "shown_progress.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/message.hpp>

namespace rths::app {
namespace {

constexpr auto kTerminalPeriod = std::chrono::seconds{1};
constexpr auto kLogPeriod = std::chrono::seconds{30};

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace

Steps::Steps(int count, Silent silent)
    : count_{count}, is_silent_{silent == Silent::OffTerminals && !on_terminal()}, thread_{[this] {
        show();
      }} {}

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
    detail_.clear();
  }
  changed_.notify_all();
}

void Steps::detail(const std::string& text, std::size_t done, std::size_t total) {
  const std::lock_guard lock{mutex_};
  if (text != detail_ || done == 0) detail_begun_ = std::chrono::steady_clock::now();
  detail_ = text;
  done_ = done;
  total_ = total;
}

// "step 1 of 2: the diagnosis, 12 s: motion to force: term 2, short fits: 7 of 20, 5 s left"
std::string Steps::line(double elapsed) const {
  std::string text = fmt::format("step {} of {}: {}, {:.0f} s", current_, count_, name_, elapsed);
  if (detail_.empty()) return text;
  text += ": " + detail_;
  if (total_ == 0 || done_ > total_) return text;
  text += fmt::format(": {} of {}", done_, total_);
  if (done_ == 0) return text;
  const double so_far =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - detail_begun_).count();
  return text + fmt::format(", {:.0f} s left", so_far * static_cast<double>(total_ - done_) /
                                                   static_cast<double>(done_));
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
    const double elapsed = std::floor(std::chrono::duration<double>(Clock::now() - begun).count());
    if (terminal) write_message(fmt::format("\r{}\033[K", line(elapsed)));
    if (!terminal && !is_new && !is_silent_)
      write_message(fmt::format("rths: {}\n", line(elapsed)));
    changed_.wait_for(lock, terminal ? kTerminalPeriod : kLogPeriod,
                      [&] { return ended_ || current_ != shown; });
  }
  if (terminal) write_message("\r\033[K");
}

ShownProgress::ShownProgress(Steps::Silent silent) {
  functions_.note = [this](const std::string& line) {
    remove_bar();
    write_message(fmt::format("rths: {}\n", line));
  };
  if (isatty(STDERR_FILENO) == 1)
    functions_.run = [this](const launch::Progress& progress) { show_bar(progress); };
  functions_.step = [this, silent](int, int count, const std::string& name) {
    if (!steps_) steps_.emplace(count, silent);
    steps_->begin(name);
  };
  functions_.fits = [this](const diagnosis::DiagnosisProgress::State& state) {
    if (steps_)
      steps_->detail(state.step.empty() ? state.stage : state.stage + ", " + state.step, state.done,
                     state.total);
  };
}

void ShownProgress::end() {
  remove_bar();
  steps_.reset();
}

void ShownProgress::show_bar(const launch::Progress& progress) {
  constexpr int kWidth = 40;
  // Ctrl-S stops the output of a terminal, and writing would stop this process.
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (poll(&terminal, 1, 0) <= 0) return;
  const double fraction = std::min(1.0, std::max(0.0, progress.model_time / progress.duration));
  const int filled = static_cast<int>(fraction * kWidth);
  has_bar_ = true;
  write_message(fmt::format("\r[{:=<{}}{: <{}}] {:6.2f} / {:.2f} s", "", filled, "",
                            kWidth - filled, fraction * progress.duration, progress.duration));
}

void ShownProgress::remove_bar() {
  if (has_bar_.exchange(false)) write_message(fmt::format("\r{: <70}\r", ""));
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include "shown_progress.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/message.hpp>

namespace rths::app {

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

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>

#include <rths/session/progress.hpp>

#include "steps.hpp"

namespace rths::app {

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

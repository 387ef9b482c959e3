// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace rths::diagnosis {

/// Progress of a diagnosis: its stage and step, and the fits of the step that are done.
class DiagnosisProgress {
 public:
  struct State {
    std::string stage;      ///< "motion to force: term 2"
    std::string step;       ///< "short fits"; empty: the stage has no steps
    std::size_t done = 0;   ///< fits
    std::size_t total = 0;  ///< fits of the step; 0: not known
  };
  using Show = std::function<void(const State&)>;

  DiagnosisProgress() = default;
  /// @param show  called at every change; null: nothing is shown
  explicit DiagnosisProgress(Show show) : show_{std::move(show)} {}

  /// Name of the part of the diagnosis, before its stages: "motion to force".
  void enter(const std::string& part) { part_ = part; }
  void begin_stage(const std::string& stage) {
    state_ = {part_.empty() ? stage : part_ + ": " + stage, "", 0, 0};
    tell();
  }
  void begin_step(const std::string& step, std::size_t total) {
    state_.step = step;
    state_.done = 0;
    state_.total = total;
    tell();
  }
  /// One more fit is done.
  void count() {
    ++state_.done;
    tell();
  }

 private:
  void tell() const {
    if (show_) show_(state_);
  }

  Show show_;
  std::string part_;
  State state_;
};

}  // namespace rths::diagnosis

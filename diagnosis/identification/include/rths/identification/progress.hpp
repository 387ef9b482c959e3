// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace rths::diagnosis {

/// Steps that the search for missing terms of a relation may integrate: some minutes.
inline constexpr double kMostSteps = 4e8;

/// Progress of a diagnosis: its stage and step, the fits of the step that are done, and the work of
/// the search, which is bounded.
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
  void enter(const std::string& part) {
    part_ = part;
    steps_ = 0;
  }
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
  /// Adds steps that simulations integrated. They bound the search, instead of the time, so that a
  /// verdict is the same on every host.
  void add_steps(double steps) { steps_ += steps; }
  /// Whether the part has integrated as many steps as a search may.
  [[nodiscard]] bool is_search_over() const { return steps_ > kMostSteps; }
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
  double steps_ = 0;  ///< of the part
};

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/target_exchange.hpp>

#include <algorithm>
#include <string>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr int kSubstepsBeforeStop = 10;

}  // namespace

TargetExchange::TargetExchange(std::vector<int> delay_substeps,
                               const PredictorCorrectorSettings& settings)
    : delay_substeps_{std::move(delay_substeps)}, sampled_(delay_substeps_.size(), false) {
  for (const int delay : delay_substeps_)
    if (delay < 0 || judge_delay(delay, settings) == DelayRating::Refused)
      throw Error{"predictor-corrector: a sampling delay of " + std::to_string(delay) +
                  " substeps in a step of " + std::to_string(settings.substeps) +
                  " leaves the integrator no time; expected less than 0.8 of the step and less "
                  "than the hold point"};
  const auto axes = static_cast<Eigen::Index>(delay_substeps_.size());
  held_displacement_.setZero(axes);
  held_force_.setZero(axes);
}

bool TargetExchange::begin(double new_target_word) noexcept {
  const bool is_new = new_target_word > 0 && new_target_word != previous_word_;
  const bool falls = new_target_word <= 0 && previous_word_ > 0;
  if (is_new) {
    number_ = new_target_word;
    switch_pc_ = true;
    at_target_ = false;
    sampled_.assign(sampled_.size(), false);
  }
  if (falls) switch_pc_ = false;
  if (new_target_word < 0 && stop_countdown_ < 0) stop_countdown_ = kSubstepsBeforeStop;
  if (stop_countdown_ > 0) --stop_countdown_;
  previous_word_ = new_target_word;
  return is_new;
}

// With a delay the sample falls into the next Predict or AutoSlowDown. The test is ≥, not
// equality, because the counter is fractional after a slow-down.
bool TargetExchange::is_due(const PredictorCorrector& command, int delay) const noexcept {
  if (delay == 0) return command.counter() >= command.settings().substeps;
  const bool beyond_target =
      command.state() == PcState::Predict || command.state() == PcState::AutoSlowDown;
  return beyond_target && command.counter() >= delay;
}

void TargetExchange::end(const PredictorCorrector& command, const Eigen::VectorXd& displacement,
                         const Eigen::VectorXd& force) noexcept {
  if (command.state() == PcState::Initialize) {
    held_displacement_ = displacement;
    held_force_ = force;
    at_target_ = true;
    return;
  }
  if (at_target_) return;
  bool all = true;
  for (std::size_t i = 0; i < sampled_.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (!sampled_[i] && is_due(command, delay_substeps_[i])) {
      held_displacement_[axis] = displacement[axis];
      held_force_[axis] = force[axis];
      sampled_[i] = true;
    }
    all = all && sampled_[i];
  }
  at_target_ = all;
}

}  // namespace rths::controller

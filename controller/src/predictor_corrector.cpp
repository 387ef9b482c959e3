// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/predictor_corrector.hpp>

#include <algorithm>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr double kSmallestIncrement = 0.001;  // lets a held command start moving again
constexpr double kWarnedDelayRatio = 0.6;
constexpr double kRefusedDelayRatio = 0.8;

}  // namespace

PredictorCorrector::PredictorCorrector(const PredictorCorrectorSettings& settings)
    : settings_{settings},
      hold_point_{hold_point(settings)},
      ramp_{std::max(1.0, (hold_point_ - settings.slow_down_from) * settings.substeps)} {
  const Require require{"predictor-corrector"};
  const double begin = settings.slow_down_from;
  require(settings.axes >= 1, "the number of axes", static_cast<double>(settings.axes),
          "at least 1");
  require(settings.substeps >= 1, "the number of substeps", settings.substeps, "at least 1");
  require(begin > 0 && begin < 1, "the begin of slow-down", begin, "a number between 0 and 1");
  require(settings.hold_at == 0 || (settings.hold_at > begin && settings.hold_at < 1),
          "the hold point", settings.hold_at, "a number between the begin of slow-down and 1");
  require(settings.largest_xi > 0 && settings.largest_xi < 1, "the largest xi", settings.largest_xi,
          "a number between 0 and 1");
  require.positive("simulation step", settings.simulation_step);
  require.positive("integration step", settings.integration_step);
  for (auto& targets : history_) targets.setZero(settings.axes);
  for (auto& rate : rate_) rate.setZero(settings.axes);
  for (Eigen::VectorXd* vector :
       {&second_rate_, &switch_command_, &command_, &velocity_, &acceleration_})
    vector->setZero(settings.axes);
}

void PredictorCorrector::substep(bool new_target, const Target& target) noexcept {
  if (!started_) start_at(target.displacement);
  const double last = settings_.substeps;
  switch (state_) {
    case PcState::Initialize:
      if (new_target) {
        counter_ = 0;
        enter_correct(target);
      }
      return;
    case PcState::Correct:
      if (new_target) {
        counter_ = 0;
        slow_down_end_ = 0;
        slow_down_increment_ = 1;
        enter_correct(target);
      } else if (counter_ >= last) {
        enter_predict();
      } else {
        correct();
      }
      return;
    case PcState::Predict:
      if (new_target) return enter_correct(target);
      if (counter_ >= settings_.slow_down_from * last) {
        state_ = PcState::AutoSlowDown;
        slow_down();
      } else {
        advance_to(std::min(counter_ + 1, hold_point_ * last));
        evaluate(Branch::Predict);
      }
      return;
    case PcState::AutoSlowDown:
      if (new_target) return enter_correct(target);
      slow_down();
      return;
  }
}

void PredictorCorrector::wait() noexcept {
  if (state_ != PcState::Initialize) lost_time_ += settings_.simulation_step / settings_.substeps;
}

// Along the path. What the counter lacks to a whole substep is lost.
void PredictorCorrector::advance_to(double counter) noexcept {
  lost_time_ +=
      std::max(0.0, 1 - (counter - counter_)) * settings_.simulation_step / settings_.substeps;
  counter_ = counter;
}

void PredictorCorrector::start_at(const Eigen::VectorXd& setpoint) noexcept {
  started_ = true;
  for (auto& targets : history_) targets = setpoint;
  command_ = setpoint;
  counter_ = settings_.substeps;
}

void PredictorCorrector::enter_correct(const Target& target) noexcept {
  state_ = PcState::Correct;
  xi_ = std::min(counter_ / settings_.substeps, settings_.largest_xi);
  // If ξ is capped, the counter is set back too, so that the command stays continuous.
  counter_ = std::min(counter_, xi_ * settings_.substeps);
  switch_command_ = command_;
  shift_history(target);
  correct();
}

void PredictorCorrector::enter_predict() noexcept {
  state_ = PcState::Predict;
  xi_ = 1;
  switch_command_ = command_;
  counter_ = 0;
  slow_down_end_ = 0;
  slow_down_increment_ = 1;
  advance_to(std::min(1.0, hold_point_ * settings_.substeps));
  evaluate(Branch::Predict);
}

void PredictorCorrector::correct() noexcept {
  const double increment =
      ramp_ > 1 ? std::clamp(slow_down_increment_ + (counter_ - slow_down_end_) / ramp_,
                             kSmallestIncrement, 1.0)
                : 1;
  advance_to(std::min(counter_ + increment, static_cast<double>(settings_.substeps)));
  evaluate(Branch::Correct);
}

void PredictorCorrector::slow_down() noexcept {
  slow_down_increment_ = (hold_point_ * settings_.substeps - counter_) / ramp_;
  advance_to(counter_ + slow_down_increment_);
  slow_down_end_ = counter_;
  evaluate(Branch::Predict);
}

// One-sided differences of fourth and fifth order, per step.
void PredictorCorrector::shift_history(const Target& target) noexcept {
  for (std::size_t i = history_.size() - 1; i > 0; --i) history_[i] = history_[i - 1];
  history_[0] = target.displacement;
  const auto& [s1, s2, s3, s4, s5, s6] = history_;
  if (settings_.targets_carry_rates) {
    const double dt = settings_.integration_step;
    rate_[1] = rate_[0];
    rate_[0] = dt * target.velocity;
    second_rate_ = dt * dt * target.acceleration;
  } else {
    rate_[0] = (25 * s1 - 48 * s2 + 36 * s3 - 16 * s4 + 3 * s5) / 12;
    rate_[1] = (3 * s1 + 10 * s2 - 18 * s3 + 6 * s4 - s5) / 12;
    second_rate_ = (45 * s1 - 154 * s2 + 214 * s3 - 156 * s4 + 61 * s5 - 10 * s6) / 12;
  }
}

void PredictorCorrector::evaluate(Branch branch) noexcept {
  const Polynomial polynomial =
      branch == Branch::Predict ? settings_.predictor : settings_.corrector;
  const Weights w = weights(polynomial, branch, counter_ / settings_.substeps, xi_);
  const double per_second = 1 / settings_.simulation_step;
  for (Eigen::Index axis = 0; axis < command_.size(); ++axis) {
    Jet sum = w.switch_command * switch_command_[axis] + w.acceleration * second_rate_[axis];
    for (std::size_t i = 0; i < w.target.size(); ++i) sum = sum + w.target[i] * history_[i][axis];
    for (std::size_t i = 0; i < w.velocity.size(); ++i) sum = sum + w.velocity[i] * rate_[i][axis];
    command_[axis] = sum.value;
    velocity_[axis] = sum.slope * per_second;
    acceleration_[axis] = sum.curvature * per_second * per_second;
  }
}

double hold_point(const PredictorCorrectorSettings& settings) {
  return settings.hold_at > 0 ? settings.hold_at : (1 + settings.slow_down_from) / 2;
}

double refused_delay_ratio(const PredictorCorrectorSettings& settings) {
  return std::min(kRefusedDelayRatio, hold_point(settings));
}

DelayRating judge_delay(int delay_substeps, const PredictorCorrectorSettings& settings) {
  const double ratio = static_cast<double>(delay_substeps) / settings.substeps;
  if (ratio >= refused_delay_ratio(settings)) return DelayRating::Refused;
  return ratio > kWarnedDelayRatio ? DelayRating::Warned : DelayRating::Fine;
}

}  // namespace rths::controller

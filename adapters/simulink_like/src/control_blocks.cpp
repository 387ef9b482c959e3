// SPDX-License-Identifier: Apache-2.0
#include "control_blocks.hpp"

#include <algorithm>
#include <limits>

namespace rths::adapters {
namespace {

void copy_in(const double* from, Eigen::VectorXd& to) { std::copy_n(from, to.size(), to.data()); }
void copy_out(const Eigen::VectorXd& from, double* to) {
  std::copy_n(from.data(), from.size(), to);
}

double length_of(const double* values, std::size_t axes) {
  return Eigen::Map<const Eigen::VectorXd>{values, static_cast<Eigen::Index>(axes)}.norm();
}

}  // namespace

PredictorCorrectorBlock::PredictorCorrectorBlock(
    const controller::PredictorCorrectorSettings& settings, std::vector<int> delay_substeps,
    double substep_period)
    : command_{settings}, exchange_{std::move(delay_substeps), settings}, period_{substep_period} {
  for (Eigen::VectorXd* vector :
       {&target_.displacement, &target_.velocity, &target_.acceleration, &displacement_, &force_})
    vector->setZero(settings.axes);
}

// Outputs the time spent in each state when the next target arrives, and the time of its arrival.
void PredictorCorrectorBlock::count(const Wires& w, bool new_target) noexcept {
  if (new_target) {
    for (std::size_t i = 0; i < 3; ++i) {
      *w.out[10 + i] = time_in_[i];
      time_in_[i] = 0;
    }
    *w.out[13] += 1;
    *w.out[14] = w.time;
  }
  const int state = static_cast<int>(command_.state());
  if (state >= 0) time_in_[state] += period_;
}

void PredictorCorrectorBlock::step(const Wires& w) noexcept {
  if (w.is_missed) {
    command_.wait();
    *w.out[15] = command_.lost_time();
    return;
  }
  copy_in(w.in[1], target_.displacement);
  copy_in(w.in[2], displacement_);
  copy_in(w.in[3], force_);
  copy_in(w.in[4], target_.velocity);
  copy_in(w.in[5], target_.acceleration);
  const bool new_target = exchange_.begin(*w.in[0]);
  command_.substep(new_target, target_);
  exchange_.end(command_, displacement_, force_);
  copy_out(command_.command(), w.out[0]);
  copy_out(command_.command_velocity(), w.out[1]);
  copy_out(command_.command_acceleration(), w.out[2]);
  copy_out(exchange_.held_displacement(), w.out[3]);
  copy_out(exchange_.held_force(), w.out[4]);
  *w.out[5] = exchange_.at_target() ? 1 : 0;
  *w.out[6] = exchange_.switch_pc() ? 1 : 0;
  *w.out[7] = static_cast<double>(command_.state());
  *w.out[8] = command_.counter();
  *w.out[9] = exchange_.stopped() ? 1 : 0;
  *w.out[15] = command_.lost_time();
  count(w, new_target);
}

// The first call sets the share without a fade.
double Fade::operator()(bool on) noexcept {
  share = share < 0 ? (on ? 1.0 : 0.0) : std::clamp(share + (on ? step : -step), 0.0, 1.0);
  return share;
}

void AtsBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[0] != 0);
  const bool adapt = *w.parameter[1] != 0;
  for (std::size_t i = 0; i < compensators.size(); ++i) {
    auto& ats = compensators[i];
    w.out[0][i] = ats.step({w.in[0][i], w.in[1][i], w.in[2][i]}, w.in[3][i], share, adapt);
    w.out[1][i] = ats.coefficients()[0];
    w.out[2][i] = ats.coefficients()[1];
    w.out[3][i] = ats.coefficients()[2];
    w.out[4][i] = static_cast<double>(ats.limited());
  }
}

void AdaptiveInverseBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[0] != 0);
  const bool adapt = *w.parameter[1] != 0;
  const controller::Pace progress = pace(*w.in[3], period, *w.in[4] != 0);
  for (std::size_t i = 0; i < compensators.size(); ++i) {
    auto& inverse = compensators[i];
    w.out[0][i] = inverse.step(w.in[0][i], w.in[1][i], w.in[2][i], share, adapt, progress);
    const controller::InverseCoefficients found = inverse.coefficients();
    w.out[1][i] = found.a0;
    w.out[2][i] = found.a1;
    w.out[3][i] = found.a2;
    w.out[4][i] = found.a3;
    w.out[5][i] = found.load;
    w.out[6][i] = found.load_rate;
    w.out[7][i] = found.dead_band;
    w.out[8][i] = found.flow_loss;
    w.out[9][i] = inverse.learning() ? 1 : 0;
    w.out[10][i] = static_cast<double>(inverse.clipped());
    w.out[11][i] = static_cast<double>(inverse.bad_samples());
  }
}

void FeedForwardBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[0] != 0);
  const controller::FeedForward lead{share * *w.parameter[1], share * *w.parameter[2]};
  for (std::size_t i = 0; i < w.axes; ++i) w.out[0][i] = lead(w.in[0][i], w.in[1][i], w.in[2][i]);
}

void ForceObserverBlock::step(const Wires& w) noexcept {
  const bool enabled = *w.parameter[0] != 0;
  for (std::size_t i = 0; i < observers.size(); ++i) {
    const double specimen = observers[i].step(w.in[0][i], w.in[1][i], w.in[2][i]);
    w.out[0][i] = enabled ? specimen : w.in[2][i];
    w.out[1][i] = observers[i].velocity();
    w.out[2][i] = observers[i].machine_force();
  }
}

void TableForceObserverBlock::step(const Wires& w) noexcept {
  const bool enabled = *w.parameter[0] != 0;
  for (std::size_t i = 0; i < observers.size(); ++i) {
    const double specimen = observers[i].step({w.in[0][i], w.in[1][i], w.in[2][i], *w.in[3]});
    w.out[0][i] = enabled ? specimen : w.in[2][i];
    w.out[1][i] = observers[i].velocity();
    w.out[2][i] = observers[i].machine_force();
    w.out[3][i] = static_cast<double>(observers[i].bad_samples());
    w.out[4][i] = enabled ? observers[i].displacement() : w.in[0][i];
  }
}

void TargetForceBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[0] != 0);
  const double load = knows_load ? *w.in[7] : std::numeric_limits<double>::quiet_NaN();
  force.step({w.in[0], w.in[1], w.in[2], w.in[3], w.in[4], w.in[5], w.in[6], load},
             *w.parameter[1] != 0);
  for (std::size_t i = 0; i < w.axes; ++i) {
    const double correction = share * force.correction()[static_cast<Eigen::Index>(i)];
    w.out[0][i] = w.in[3][i] + correction;
    w.out[1][i] = correction;
    w.out[5][i] = leads ? force.ahead()[static_cast<Eigen::Index>(i)] : w.in[3][i];
  }
  *w.out[2] = force.strengths().sum();
  *w.out[3] = force.learning() ? 1 : 0;
  *w.out[4] = static_cast<double>(force.bad_samples());
  *w.out[6] = leads ? 1 : 0;
}

void VerticalForceBlock::step(const Wires& w) noexcept {
  const double target = *w.in[0];
  const double measured = *w.in[1];
  const double wanted = is_cascade ? cascade.step(target, measured)
                                   : lead.step(target, measured, length_of(w.in[2], w.axes),
                                               length_of(w.in[3], w.axes), *w.parameter[0] != 0,
                                               pace(*w.in[4], period).share);
  if (!first) first = wanted;
  *w.out[0] = std::clamp(wanted - *first, -limit, limit);
  *w.out[1] = lead.disturbance();
  *w.out[2] = lead.inverse().coefficients().a0;
  *w.out[3] = lead.inverse().coefficients().a1;
  *w.out[4] = lead.inverse().learning() ? 1 : 0;
  *w.out[5] = static_cast<double>(lead.inverse().clipped());
  *w.out[6] = static_cast<double>(lead.inverse().bad_samples());
}

void LagCorrectionBlock::step(const Wires& w) noexcept {
  const double measured = *w.in[1];
  const double corrected = correction.step(*w.in[0], measured, *w.parameter[1] != 0);
  *w.out[0] = measured + fade(*w.parameter[0] != 0) * (corrected - measured);
  *w.out[1] = correction.gain();
  *w.out[2] = correction.lag();
}

}  // namespace rths::adapters

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
      *w.out[Out::kCorrectTime + i] = time_in_[i];
      time_in_[i] = 0;
    }
    *w.out[Out::kTargets] += 1;
    *w.out[Out::kTargetTime] = w.time;
  }
  const int state = static_cast<int>(command_.state());
  if (state >= 0) time_in_[state] += period_;
}

void PredictorCorrectorBlock::step(const Wires& w) noexcept {
  if (w.is_missed) {
    command_.wait();
    *w.out[Out::kLostTime] = command_.lost_time();
    return;
  }
  copy_in(w.in[In::kTarget], target_.displacement);
  copy_in(w.in[In::kDisplacement], displacement_);
  copy_in(w.in[In::kForce], force_);
  copy_in(w.in[In::kTargetVelocity], target_.velocity);
  copy_in(w.in[In::kTargetAcceleration], target_.acceleration);
  const bool new_target = exchange_.begin(*w.in[In::kNewTarget]);
  command_.substep(new_target, target_);
  exchange_.end(command_, displacement_, force_);
  copy_out(command_.command(), w.out[Out::kCommand]);
  copy_out(command_.command_velocity(), w.out[Out::kVelocity]);
  copy_out(command_.command_acceleration(), w.out[Out::kAcceleration]);
  copy_out(exchange_.held_displacement(), w.out[Out::kHeldDisplacement]);
  copy_out(exchange_.held_force(), w.out[Out::kHeldForce]);
  *w.out[Out::kAtTarget] = exchange_.at_target() ? exchange_.number() : 0;
  *w.out[Out::kSwitchPc] = exchange_.switch_pc() ? 1 : 0;
  *w.out[Out::kState] = static_cast<double>(command_.state());
  *w.out[Out::kCounter] = command_.counter();
  *w.out[Out::kStopped] = exchange_.stopped() ? 1 : 0;
  *w.out[Out::kLostTime] = command_.lost_time();
  count(w, new_target);
}

// The first call sets the share without a fade.
double Fade::operator()(bool on) noexcept {
  share = share < 0 ? (on ? 1.0 : 0.0) : std::clamp(share + (on ? step : -step), 0.0, 1.0);
  return share;
}

void AtsBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[Parameter::kEnabled] != 0);
  const bool adapt = *w.parameter[Parameter::kAdapt] != 0;
  for (std::size_t i = 0; i < compensators.size(); ++i) {
    auto& ats = compensators[i];
    w.out[Out::kReference][i] =
        ats.step({w.in[In::kCommand][i], w.in[In::kVelocity][i], w.in[In::kAcceleration][i]},
                 w.in[In::kMeasured][i], share, adapt);
    w.out[Out::kA0][i] = ats.coefficients()[0];
    w.out[Out::kA1][i] = ats.coefficients()[1];
    w.out[Out::kA2][i] = ats.coefficients()[2];
    w.out[Out::kLimited][i] = static_cast<double>(ats.limited());
  }
}

void AdaptiveInverseBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[Parameter::kEnabled] != 0);
  const bool adapt = *w.parameter[Parameter::kAdapt] != 0;
  const controller::Pace progress =
      pace(*w.in[In::kLostTime], period, *w.in[In::kIsForceAhead] != 0);
  for (std::size_t i = 0; i < compensators.size(); ++i) {
    auto& inverse = compensators[i];
    w.out[Out::kReference][i] = inverse.step(w.in[In::kCommand][i], w.in[In::kMeasured][i],
                                             w.in[In::kForce][i], share, adapt, progress);
    const controller::InverseCoefficients found = inverse.coefficients();
    w.out[Out::kA0][i] = found.a0;
    w.out[Out::kA1][i] = found.a1;
    w.out[Out::kA2][i] = found.a2;
    w.out[Out::kA3][i] = found.a3;
    w.out[Out::kLoad][i] = found.load;
    w.out[Out::kLoadRate][i] = found.load_rate;
    w.out[Out::kDeadBand][i] = found.dead_band;
    w.out[Out::kFlowLoss][i] = found.flow_loss;
    w.out[Out::kLearning][i] = inverse.learning() ? 1 : 0;
    w.out[Out::kClipped][i] = static_cast<double>(inverse.clipped());
    w.out[Out::kBadSamples][i] = static_cast<double>(inverse.bad_samples());
  }
}

void FeedForwardBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[Parameter::kEnabled] != 0);
  const controller::FeedForward lead{share * *w.parameter[Parameter::kVelocityGain],
                                     share * *w.parameter[Parameter::kAccelerationGain]};
  for (std::size_t i = 0; i < w.axes; ++i)
    w.out[Out::kReference][i] =
        lead(w.in[In::kReference][i], w.in[In::kVelocity][i], w.in[In::kAcceleration][i]);
}

void ForceObserverBlock::step(const Wires& w) noexcept {
  const bool enabled = *w.parameter[Parameter::kEnabled] != 0;
  for (std::size_t i = 0; i < observers.size(); ++i) {
    const double specimen = observers[i].step(w.in[In::kDisplacement][i],
                                              w.in[In::kAcceleration][i], w.in[In::kForce][i]);
    w.out[Out::kForce][i] = enabled ? specimen : w.in[In::kForce][i];
    w.out[Out::kVelocity][i] = observers[i].velocity();
    w.out[Out::kMachineForce][i] = observers[i].machine_force();
  }
}

void TableForceObserverBlock::step(const Wires& w) noexcept {
  const bool enabled = *w.parameter[Parameter::kEnabled] != 0;
  for (std::size_t i = 0; i < observers.size(); ++i) {
    const double specimen =
        observers[i].step({w.in[In::kDisplacement][i], w.in[In::kAcceleration][i],
                           w.in[In::kForce][i], *w.in[In::kAxialLoad]});
    w.out[Out::kForce][i] = enabled ? specimen : w.in[In::kForce][i];
    w.out[Out::kVelocity][i] = observers[i].velocity();
    w.out[Out::kMachineForce][i] = observers[i].machine_force();
    w.out[Out::kBadSamples][i] = static_cast<double>(observers[i].bad_samples());
    w.out[Out::kDisplacement][i] =
        enabled ? observers[i].displacement() : w.in[In::kDisplacement][i];
  }
}

void TargetForceBlock::step(const Wires& w) noexcept {
  const double share = fade(*w.parameter[Parameter::kEnabled] != 0);
  const double load = knows_load ? *w.in[In::kAxialLoad] : std::numeric_limits<double>::quiet_NaN();
  force.step({w.in[In::kTarget], w.in[In::kDisplacement], w.in[In::kAcceleration], w.in[In::kForce],
              w.in[In::kCommand], w.in[In::kCommandVelocity], w.in[In::kCommandAcceleration], load},
             *w.parameter[Parameter::kAdapt] != 0);
  for (std::size_t i = 0; i < w.axes; ++i) {
    const double correction = share * force.correction()[static_cast<Eigen::Index>(i)];
    w.out[Out::kForce][i] = w.in[In::kForce][i] + correction;
    w.out[Out::kCorrection][i] = correction;
    w.out[Out::kAhead][i] =
        leads ? force.ahead()[static_cast<Eigen::Index>(i)] : w.in[In::kForce][i];
  }
  *w.out[Out::kStrength] = force.strengths().sum();
  *w.out[Out::kLearning] = force.learning() ? 1 : 0;
  *w.out[Out::kBadSamples] = static_cast<double>(force.bad_samples());
  *w.out[Out::kIsAhead] = leads ? 1 : 0;
}

void VerticalForceBlock::step(const Wires& w) noexcept {
  const double target = *w.in[In::kTarget];
  const double measured = *w.in[In::kMeasured];
  const double wanted =
      is_cascade ? cascade.step(target, measured)
                 : lead.step(target, measured, length_of(w.in[In::kHorizontalTarget], w.axes),
                             length_of(w.in[In::kHorizontal], w.axes),
                             *w.parameter[Parameter::kAdapt] != 0,
                             pace(*w.in[In::kLostTime], period).share);
  if (!first) first = wanted;
  *w.out[Out::kReference] = std::clamp(wanted - *first, -limit, limit);
  *w.out[Out::kDisturbance] = lead.disturbance();
  *w.out[Out::kA0] = lead.inverse().coefficients().a0;
  *w.out[Out::kA1] = lead.inverse().coefficients().a1;
  *w.out[Out::kLearning] = lead.inverse().learning() ? 1 : 0;
  *w.out[Out::kClipped] = static_cast<double>(lead.inverse().clipped());
  *w.out[Out::kBadSamples] = static_cast<double>(lead.inverse().bad_samples());
}

void LagCorrectionBlock::step(const Wires& w) noexcept {
  const double measured = *w.in[In::kMeasured];
  const double corrected =
      correction.step(*w.in[In::kCommand], measured, *w.parameter[Parameter::kAdapt] != 0);
  *w.out[Out::kForce] =
      measured + fade(*w.parameter[Parameter::kEnabled] != 0) * (corrected - measured);
  *w.out[Out::kGain] = correction.gain();
  *w.out[Out::kLag] = correction.lag();
}

}  // namespace rths::adapters

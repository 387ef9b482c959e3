// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/target_force.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <rths/core/error.hpp>

#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr Require kRequireTargetForce{"force at the target"};

constexpr double kLeastReach = 1e-6, kLargestReach = 10;  // the squares of u/r stay finite [m]
constexpr double kRidge = 1e-3;        // pulls strengths to the prior, of each one's information
constexpr double kPriorSamples = 300;  // information of the expected strengths
constexpr double kMeanSquareMemory = 0.25;              // of the mean square speed [s]
constexpr long kMostPieces = 100;                       // of the way between two targets
constexpr double kSpringReach = 1;                      // beside the assumed specimen [m]
constexpr double kFirstMove = 0.15, kFirstSpeed = 0.2;  // that scales its force [m], [m/s]
constexpr double kRestLoad = std::numeric_limits<double>::quiet_NaN();

bool is_finite(const double* values, Eigen::Index count) {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

}  // namespace

Sliders::Sliders(const std::vector<double>& sharp, const std::vector<double>& smooth,
                 Eigen::Index axes)
    : sharp_{static_cast<Eigen::Index>(sharp.size())}, flexibility_{sharp.size() + smooth.size()} {
  for (Eigen::Index j = 0; j < flexibility_.size(); ++j)
    flexibility_[j] = 1 / (j < sharp_ ? sharp[static_cast<std::size_t>(j)]
                                      : smooth[static_cast<std::size_t>(j - sharp_)]);
  states_.setZero(axes, flexibility_.size());
}

void Sliders::move(const Eigen::VectorXd& step) noexcept {
  const double length = step.norm();
  if (!(length > 0)) return;
  for (Eigen::Index j = 0; j < states_.cols(); ++j) {
    auto z = states_.col(j);
    if (j < sharp_) {
      z += flexibility_[j] * step;
      z /= std::max(1.0, z.norm());
      continue;
    }
    // The exact solution: elastic until z no longer points backwards, then towards the step.
    double left = flexibility_[j] * length;
    const double back = std::clamp(-z.dot(step) / length, 0.0, left);
    z += back / length * step;
    left -= back;
    const double t = std::tanh(left), along = z.dot(step) / length;
    const double shrink = std::sqrt(1 - t * t);
    z = (shrink * z + ((1 - shrink) * along + t) / length * step) / (1 + along * t);
  }
}

/// The parts of a force, each of unit strength, in motion.
class Parts {
 public:
  /// @param scale  of the assumed specimen's force [N]
  Parts(const TargetForceSettings& s, double scale)
      : sliders_{s.specimen ? std::vector<double>{kSpringReach} : s.reach,
                 s.specimen ? std::vector<double>{} : s.smooth_reach, s.axes},
        scale_{scale},
        at_{Eigen::VectorXd::Zero(s.axes)} {
    if (!s.specimen) return;
    specimen_ = s.specimen();
    states_.setZero(s.axes, 2);
  }
  void move(const Eigen::VectorXd& step, const Eigen::VectorXd& velocity, double load) noexcept {
    sliders_.move(step);
    if (!specimen_) return;
    at_ += step;
    const Eigen::VectorXd& force = specimen_->move(at_, velocity, load);
    if (is_finite(force.data(), force.size())) states_.col(0) = force / scale_;
    states_.col(1) = sliders_.states().col(0);
  }
  /// axes × parts [-]
  [[nodiscard]] const Eigen::MatrixXd& states() const {
    return specimen_ ? states_ : sliders_.states();
  }

 private:
  Sliders sliders_;
  std::unique_ptr<SpecimenModel> specimen_;
  double scale_;
  Eigen::VectorXd at_;  ///< from the start [m]
  Eigen::MatrixXd states_;
};

/// Least squares with non-negative strengths: one sweep of projected Gauss-Seidel per sample.
class StrengthFit {
 public:
  StrengthFit(const Eigen::VectorXd& expected, Eigen::Index axes)
      : strengths_{expected.size()}, prior_{Eigen::VectorXd::Zero(strengths_ + axes)} {
    prior_.head(strengths_) = expected;
    solution_ = prior_;
    factors_.setZero(prior_.size());
    normal_.setZero(prior_.size(), prior_.size());
    if (!expected.isZero(0)) normal_.diagonal().head(strengths_).setConstant(kPriorSamples);
    right_side_ = normal_ * prior_;
  }
  void forget(double share) noexcept {
    normal_ *= share;
    right_side_ *= share;
  }
  void add(const Eigen::MatrixXd& states, Eigen::Index axis, double force) noexcept {
    factors_.setZero();
    factors_.head(strengths_) = states.row(axis).transpose();
    factors_[strengths_ + axis] = 1;
    normal_.noalias() += factors_ * factors_.transpose();
    right_side_ += force * factors_;
  }
  void sweep() noexcept {
    for (Eigen::Index i = 0; i < solution_.size(); ++i) {
      if (!(normal_(i, i) > 0)) continue;
      const double diagonal = (1 + kRidge) * normal_(i, i);
      const double residual = right_side_[i] - normal_.col(i).dot(solution_) +
                              kRidge * normal_(i, i) * (prior_[i] - solution_[i]);
      solution_[i] += residual / diagonal;
      if (i < strengths_) solution_[i] = std::max(0.0, solution_[i]);
    }
  }
  [[nodiscard]] double operator[](Eigen::Index i) const { return solution_[i]; }

 private:
  Eigen::Index strengths_;
  Eigen::VectorXd prior_, solution_;  // strengths, then an offset per axis
  Eigen::VectorXd factors_, right_side_;
  Eigen::MatrixXd normal_;
};

namespace {

// Force of the assumed specimen after a first move of strong motion [N].
double first_force(SpecimenModel& specimen, const TargetForceSettings& s) {
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(s.axes), velocity = displacement;
  velocity[0] = kFirstSpeed;
  double force = 0;
  for (double u = kFirstSpeed * s.period; u <= kFirstMove; u += kFirstSpeed * s.period) {
    displacement[0] = u;
    force = specimen.move(displacement, velocity, kRestLoad).norm();
  }
  return force;
}

double scale_of(const TargetForceSettings& s) {
  if (!s.specimen) return 1;
  const double force = first_force(*s.specimen(), s);
  kRequireTargetForce(force > 0 && std::isfinite(force), "force of the assumed specimen", force,
                      "a positive one [N] after a move of 150 mm");
  return force;
}

Eigen::VectorXd expected_strengths(const TargetForceSettings& s, double scale) {
  if (s.specimen) return Eigen::Vector2d{scale, 0};
  const auto sliders = static_cast<Eigen::Index>(s.reach.size() + s.smooth_reach.size());
  if (s.expected.empty()) return Eigen::VectorXd::Zero(sliders);
  return Eigen::Map<const Eigen::VectorXd>{s.expected.data(), sliders};
}

}  // namespace

struct TargetForce::State {
  State(const TargetForceSettings& s, double scale)
      : settings{s},
        axes{s.axes},
        path_pieces{std::clamp(std::lround(s.interval / s.period), 1L, kMostPieces)},
        at_target{s, scale},
        measured{s, scale},
        leading{s, scale},
        strengths{expected_strengths(s, scale)},
        fit{strengths, axes},
        fused(static_cast<std::size_t>(axes), FusedMotion{s.motion_bandwidth, s.period}) {
    for (Eigen::VectorXd* v : {&target, &last_target, &displacement, &step, &velocity, &correction,
                               &force, &acceleration, &raw, &ahead, &led})
      v->setZero(axes);
  }

  // The way to a new target continues the curvature of the last three, usually a period per piece.
  void follow_target(const double* found) noexcept {
    const Eigen::Map<const Eigen::VectorXd> next{found, axes};
    if ((next - target).isZero(0)) return;
    const auto pieces = static_cast<double>(path_pieces);
    for (long i = 0; i < path_pieces; ++i) {
      const double a = static_cast<double>(i) / pieces, b = a + 1 / pieces;
      const double bend = (a * (1 - a) - b * (1 - b)) / 2;
      step = (b - a) * (next - target) + bend * (next - 2 * target + last_target);
      velocity = pieces / settings.interval * step;
      at_target.move(step, velocity, load);
    }
    last_target = target;
    target = next;
  }

  void follow_motion() noexcept {
    double square = 0;
    for (Eigen::Index i = 0; i < axes; ++i) {
      auto& axis = fused[static_cast<std::size_t>(i)];
      velocity[i] = axis(raw[i], acceleration[i]);
      square += velocity[i] * velocity[i];
      step[i] = axis.displacement() - displacement[i];
      displacement[i] = axis.displacement();
    }
    measured.move(step, velocity, load);
    mean_square_speed += settings.period / kMeanSquareMemory * (square - mean_square_speed);
  }

  // An extrapolation that is not finite is left out: the last force ahead is held.
  void lead(const Sample& sample) noexcept {
    if (!(settings.lead_time > 0) || sample.command == nullptr) return;
    const Eigen::Map<const Eigen::VectorXd> x{sample.command, axes};
    const Eigen::Map<const Eigen::VectorXd> v{sample.command_velocity, axes};
    const Eigen::Map<const Eigen::VectorXd> a{sample.command_acceleration, axes};
    const double t = settings.lead_time;
    step = x + t * v + t * t / 2 * a - led;
    if (!step.allFinite()) return;
    led += step;
    velocity = v + t * a;
    leading.move(step, velocity, load);
    ahead.noalias() = leading.states() * strengths;
    for (Eigen::Index i = 0; i < axes; ++i) ahead[i] += fit[strengths.size() + i];
  }

  void learn(bool adapt) noexcept {
    learning = adapt && mean_square_speed > settings.informative_speed * settings.informative_speed;
    if (!learning) return;
    fit.forget(1 - settings.period / settings.forgetting);
    for (Eigen::Index i = 0; i < axes; ++i) fit.add(measured.states(), i, force[i]);
    fit.sweep();
    for (Eigen::Index j = 0; j < strengths.size(); ++j) strengths[j] = fit[j];
  }

  TargetForceSettings settings;
  Eigen::Index axes;
  long path_pieces;  ///< of the way between two targets
  Parts at_target, measured, leading;
  Eigen::VectorXd strengths;
  StrengthFit fit;
  std::vector<FusedMotion> fused;
  Eigen::VectorXd target, last_target, displacement, step, velocity, correction, force,
      acceleration, raw, ahead, led;
  double load = kRestLoad, mean_square_speed = 0;
  bool learning = false, started = false;
  long bad_samples = 0;
};

TargetForce::TargetForce(const TargetForceSettings& settings) {
  kRequireTargetForce(settings.axes >= 1, "number of axes", settings.axes, "at least 1");
  kRequireTargetForce.positive("period", settings.period);
  kRequireTargetForce.positive("interval of the targets", settings.interval);
  kRequireTargetForce(!settings.reach.empty(), "number of sliders", 0, "at least 1");
  for (const auto* sliders : {&settings.reach, &settings.smooth_reach})
    for (const double reach : *sliders)
      kRequireTargetForce(reach >= kLeastReach && reach <= kLargestReach, "reach of a slider",
                          reach, "1e-6 to 10 m");
  const std::size_t sliders = settings.reach.size() + settings.smooth_reach.size();
  if (!settings.expected.empty() && settings.expected.size() != sliders)
    kRequireTargetForce(false, "number of expected strengths",
                        static_cast<double>(settings.expected.size()), "one of each slider");
  for (const double strength : settings.expected)
    kRequireTargetForce(strength >= 0 && std::isfinite(strength), "expected strength", strength,
                        "at least 0 N");
  kRequireTargetForce(settings.lead_time >= 0, "lead time", settings.lead_time, "at least 0 s");
  kRequireTargetForce(settings.forgetting > settings.period, "forgetting", settings.forgetting,
                      "more than a period");
  state_ = std::make_unique<State>(settings, scale_of(settings));
}

TargetForce::~TargetForce() = default;
TargetForce::TargetForce(TargetForce&&) noexcept = default;
TargetForce& TargetForce::operator=(TargetForce&&) noexcept = default;

void TargetForce::step(const Sample& sample, bool adapt) noexcept {
  State& s = *state_;
  const bool good = is_finite(sample.displacement, s.axes) && is_finite(sample.force, s.axes) &&
                    is_finite(sample.acceleration, s.axes);
  const bool has_target = is_finite(sample.target, s.axes);
  if (!good || !has_target) ++s.bad_samples;
  s.load = sample.axial_load;
  if (good) {
    std::copy_n(sample.displacement, s.axes, s.raw.data());
    std::copy_n(sample.acceleration, s.axes, s.acceleration.data());
    std::copy_n(sample.force, s.axes, s.force.data());
  }
  if (!s.started) {
    if (!has_target) return;
    std::copy_n(sample.target, s.axes, s.target.data());
    s.last_target = s.target;
    s.displacement = s.led = s.target;  // a specimen without force
    s.started = true;
  }
  if (has_target) s.follow_target(sample.target);
  s.follow_motion();
  s.learn(adapt && good);
  s.lead(sample);
  s.correction.noalias() = s.at_target.states() * s.strengths;
  s.correction.noalias() -= s.measured.states() * s.strengths;
}

const Eigen::VectorXd& TargetForce::correction() const { return state_->correction; }
const Eigen::VectorXd& TargetForce::ahead() const { return state_->ahead; }
const Eigen::VectorXd& TargetForce::strengths() const { return state_->strengths; }
bool TargetForce::learning() const { return state_->learning; }
long TargetForce::bad_samples() const { return state_->bad_samples; }

}  // namespace rths::controller

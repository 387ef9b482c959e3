// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/target_force.hpp>

#include <algorithm>
#include <cmath>

#include "require.hpp"
#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr Require kRequireTargetForce{"force at the target"};

constexpr int kPathPieces = 10;        // of the way between two targets
constexpr double kRidge = 1e-3;        // pulls strengths to zero, of each one's own information
constexpr double kSpeedMemory = 0.25;  // of the mean square speed [s]

bool is_finite(const double* values, Eigen::Index count) {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

}  // namespace

Sliders::Sliders(const std::vector<double>& reach, Eigen::Index axes) {
  const auto count = static_cast<Eigen::Index>(reach.size());
  flexibility_ = Eigen::Map<const Eigen::VectorXd>{reach.data(), count}.cwiseInverse();
  states_.setZero(axes, count);
}

void Sliders::move(const Eigen::VectorXd& step) noexcept {
  for (Eigen::Index j = 0; j < states_.cols(); ++j) {
    auto z = states_.col(j);
    z += flexibility_[j] * step;
    const double length = z.norm();
    if (length > 1) z /= length;
  }
}

/// Least squares with non-negative strengths: one sweep of projected Gauss-Seidel per sample.
class StrengthFit {
 public:
  StrengthFit(Eigen::Index strengths, Eigen::Index axes)
      : strengths_{strengths}, solution_{Eigen::VectorXd::Zero(strengths + axes)} {
    factors_ = right_side_ = solution_;
    normal_.setZero(solution_.size(), solution_.size());
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
      const double residual =
          right_side_[i] - normal_.col(i).dot(solution_) - kRidge * normal_(i, i) * solution_[i];
      solution_[i] += residual / diagonal;
      if (i < strengths_) solution_[i] = std::max(0.0, solution_[i]);
    }
  }
  [[nodiscard]] double operator[](Eigen::Index i) const { return solution_[i]; }
  [[nodiscard]] Eigen::Index strengths() const { return strengths_; }

 private:
  Eigen::Index strengths_;
  Eigen::VectorXd solution_;  // strengths, then an offset per axis
  Eigen::VectorXd factors_, right_side_;
  Eigen::MatrixXd normal_;
};

struct TargetForce::State {
  explicit State(const TargetForceSettings& s)
      : settings{s},
        axes{s.axes},
        at_target{s.reach, axes},
        measured{s.reach, axes},
        fit{static_cast<Eigen::Index>(s.reach.size()), axes},
        fused(static_cast<std::size_t>(axes), FusedMotion{s.motion_bandwidth, s.period}) {
    for (Eigen::VectorXd* v :
         {&target, &last_target, &displacement, &step, &correction, &force, &acceleration, &raw})
      v->setZero(axes);
    strengths.setZero(fit.strengths());
  }

  // The way to a new target continues the curvature of the last three.
  void follow_target(const double* found) noexcept {
    const Eigen::Map<const Eigen::VectorXd> next{found, axes};
    if ((next - target).isZero(0)) return;
    for (int i = 0; i < kPathPieces; ++i) {
      const double a = static_cast<double>(i) / kPathPieces, b = a + 1.0 / kPathPieces;
      const double bend = (a * (1 - a) - b * (1 - b)) / 2;
      step = (b - a) * (next - target) + bend * (next - 2 * target + last_target);
      at_target.move(step);
    }
    last_target = target;
    target = next;
  }

  void follow_motion() noexcept {
    double square = 0;
    for (Eigen::Index i = 0; i < axes; ++i) {
      auto& axis = fused[static_cast<std::size_t>(i)];
      const double v = axis(raw[i], acceleration[i]);
      square += v * v;
      step[i] = axis.displacement() - displacement[i];
      displacement[i] = axis.displacement();
    }
    measured.move(step);
    mean_square_speed += settings.period / kSpeedMemory * (square - mean_square_speed);
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
  Sliders at_target, measured;
  StrengthFit fit;
  std::vector<FusedMotion> fused;
  Eigen::VectorXd target, last_target, displacement, step, correction, force, acceleration, raw,
      strengths;
  double mean_square_speed = 0;
  bool learning = false, started = false;
  long bad_samples = 0;
};

TargetForce::TargetForce(const TargetForceSettings& settings) {
  kRequireTargetForce(settings.axes >= 1, "number of axes", settings.axes, "at least 1");
  kRequireTargetForce.positive("period", settings.period);
  kRequireTargetForce(!settings.reach.empty(), "number of sliders", 0, "at least 1");
  for (const double reach : settings.reach)
    kRequireTargetForce.positive("reach of a slider", reach);
  kRequireTargetForce(settings.forgetting > settings.period, "forgetting", settings.forgetting,
                      "more than a period");
  state_ = std::make_unique<State>(settings);
}

TargetForce::~TargetForce() = default;
TargetForce::TargetForce(TargetForce&&) noexcept = default;
TargetForce& TargetForce::operator=(TargetForce&&) noexcept = default;

void TargetForce::step(const Sample& sample, bool adapt) noexcept {
  State& s = *state_;
  const bool good = is_finite(sample.displacement, s.axes) && is_finite(sample.force, s.axes) &&
                    is_finite(sample.acceleration, s.axes);
  if (good) {
    std::copy_n(sample.displacement, s.axes, s.raw.data());
    std::copy_n(sample.acceleration, s.axes, s.acceleration.data());
    std::copy_n(sample.force, s.axes, s.force.data());
  } else {
    ++s.bad_samples;
  }
  if (!s.started) {
    std::copy_n(sample.target, s.axes, s.target.data());
    s.last_target = s.target;
    s.displacement = s.target;  // a specimen without force
    s.started = true;
  }
  if (is_finite(sample.target, s.axes)) s.follow_target(sample.target);
  s.follow_motion();
  s.learn(adapt && good);
  s.correction.noalias() = s.at_target.states() * s.strengths;
  s.correction.noalias() -= s.measured.states() * s.strengths;
}

const Eigen::VectorXd& TargetForce::correction() const { return state_->correction; }
const Eigen::VectorXd& TargetForce::strengths() const { return state_->strengths; }
bool TargetForce::learning() const { return state_->learning; }
long TargetForce::bad_samples() const { return state_->bad_samples; }

}  // namespace rths::controller

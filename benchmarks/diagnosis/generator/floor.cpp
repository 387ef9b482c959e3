// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "least_squares.hpp"
#include "motion.hpp"
#include "truth.hpp"

namespace trial {
namespace {

constexpr int kIterations = 5;

double mean(const Signal& signal, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t k = begin; k < end; ++k) sum += signal[k];
  return sum / static_cast<double>(end - begin);
}

// The measured motion and force of one record.
class Measured {
 public:
  Measured(const TrialCase& trial, std::size_t record)
      : motion_(measured_motion(trial.records[record], trial.physics, trial.noise)) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Signal force = compared(axis_of(trial.records[record].force, axis), kSampleTime);
      force_.insert(force_.end(), force.begin(), force.end());
    }
  }

  // Measured minus computed force, each axis without its mean [N].
  [[nodiscard]] Signal residual(const Physics& physics) const {
    const std::vector<Plane> computed = force_at(physics, motion_);
    Signal rest = force_;
    const std::size_t half = rest.size() / 2;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Signal force = compared(axis_of(computed, axis), kModelStep);
      for (std::size_t k = 0; k < half; ++k) rest[axis * half + k] -= force[k];
    }
    return centred(std::move(rest));
  }

  [[nodiscard]] double nrmse(const Physics& physics) const {
    const Signal error = residual(physics), whole = centred(force_);
    return std::sqrt(dot(error, error) / dot(whole, whole));
  }

 private:
  static Signal centred(Signal both) {
    const std::size_t half = both.size() / 2;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double offset = mean(both, axis * half, (axis + 1) * half);
      for (std::size_t k = 0; k < half; ++k) both[axis * half + k] -= offset;
    }
    return both;
  }

  Motion motion_;
  Signal force_;
};

bool is_of_force(const Effect& effect) { return effect.relation == Relation::Force; }

}  // namespace

Floor floor_of(const TrialCase& trial) {
  const Measured fit_record{trial, 0}, second{trial, 1}, unseen{trial, 2};
  const auto both = [&](const Physics& physics) {
    Signal residual = fit_record.residual(physics);
    const Signal more = second.residual(physics);
    residual.insert(residual.end(), more.begin(), more.end());
    return residual;
  };
  const std::vector<Parameter> bearing{kStiffness, kStrength, kYieldDisplacement, kExponent};
  std::vector<Parameter> known = bearing;
  Physics without = trial.physics;
  for (const Effect* hidden : trial.hidden) {
    if (!is_of_force(*hidden)) continue;
    remove(*hidden, without);
    without[kClipLimit] = info(kClipLimit).absent;
    const std::vector<Parameter> own = fitted_parameters(*hidden);
    known.insert(known.end(), own.begin(), own.end());
  }
  return {unseen.nrmse(fit(both, known, trial.physics, kIterations).physics),
          unseen.nrmse(fit(both, bearing, without, kIterations).physics), unseen.nrmse(absent())};
}

}  // namespace trial

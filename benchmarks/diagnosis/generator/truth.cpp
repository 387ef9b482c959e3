// SPDX-License-Identifier: Apache-2.0
#include "truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "least_squares.hpp"
#include "observer.hpp"

namespace trial {
namespace {

std::vector<Parameter> nuisances(Relation relation) {
  if (relation == Relation::Force)
    return {kStiffness, kStrength, kYieldDisplacement, kExponent, kOffsetX, kOffsetY};
  if (relation == Relation::Kinematic) return {kAccelerationOffsetX, kAccelerationOffsetY};
  return {};
}

// Compares signals after removal of their projection on the nuisance parameters.
class Rivalry {
 public:
  Rivalry(const TrialCase& trial, const Effect& effect)
      : observer_(trial, 0, effect.relation), without_(trial.physics_of(0)) {
    const Physics with = without_;
    remove(effect, without_);
    if (effect.name == "loadcell_saturation") without_[kClipLimit] = info(kClipLimit).absent;
    if (effect.name == "rate_saturation") without_[kSpeedLimit] = info(kSpeedLimit).absent;
    base_ = observer_.seen(without_);
    const bool by_recorder = effect.name == "quantisation" || effect.name == "dropout";
    effect_ = by_recorder ? observer_.seen_of_recorder() : difference(observer_.seen(with), base_);
    for (const Parameter nuisance : nuisances(effect.relation)) {
      Physics beside = without_;
      beside[nuisance] += info(nuisance).step;
      nuisances_.add(difference(observer_.seen(beside), base_));
    }
    rest_ = nuisances_.outside(effect_);
  }

  [[nodiscard]] const Signal& of_effect() const { return effect_; }
  [[nodiscard]] const Signal& rest() const { return rest_; }
  [[nodiscard]] const Record& record() const { return observer_.record(); }
  [[nodiscard]] double separation_from(const Effect& rival) const;

 private:
  [[nodiscard]] double linear_cost(const Effect& rival, Physics& start) const;
  [[nodiscard]] double start_of(const Draw& draw, double share) const;
  [[nodiscard]] Signal left(const Physics& physics) const {
    return difference(rest_, nuisances_.outside(difference(observer_.seen(physics), base_)));
  }

  Observer observer_;
  Physics without_;
  Signal base_, effect_, rest_;
  Subspace nuisances_;
};

double Rivalry::start_of(const Draw& draw, double share) const {
  if (draw.parameter == kClipShare) return (1 - 0.3 * share) * observer_.record().peak_force();
  if (draw.parameter == kSpeedShare) return (1 - 0.4 * share) * observer_.record().peak_speed();
  return draw.low + share * (draw.high - draw.low);
}

Parameter moved_by_fit(Parameter parameter) {
  if (parameter == kClipShare) return kClipLimit;
  return parameter == kSpeedShare ? kSpeedLimit : parameter;
}

// Cost of the rival with free sizes, for given start values of its other parameters.
double Rivalry::linear_cost(const Effect& rival, Physics& start) const {
  const Physics shape = start;
  std::vector<Signal> columns;
  for (const Draw& draw : rival.draws) {
    if (!draw.is_size) continue;
    Physics one = shape;
    for (const Draw& other : rival.draws) {
      const Parameter parameter = moved_by_fit(other.parameter);
      if (other.is_size && other.parameter != draw.parameter) one[parameter] = without_[parameter];
    }
    columns.push_back(nuisances_.outside(difference(observer_.seen(one), base_)));
  }
  Subspace spanned;
  for (const Signal& column : columns) spanned.add(column);
  const Signal unexplained = spanned.outside(rest_);
  // Start values for the fit: each size alone, from its projection on the effect.
  std::size_t next = 0;
  for (const Draw& draw : rival.draws) {
    if (!draw.is_size) continue;
    const Signal& column = columns[next++];
    const Parameter parameter = moved_by_fit(draw.parameter);
    const double square = dot(column, column);
    const double share = square > 0 ? dot(column, rest_) / square : 0;
    if (parameter == draw.parameter)
      start[parameter] =
          std::clamp(without_[parameter] + share * (shape[parameter] - without_[parameter]),
                     info(parameter).low, info(parameter).high);
  }
  return dot(unexplained, unexplained);
}

double Rivalry::separation_from(const Effect& rival) const {
  constexpr std::array<double, 3> kShares{0.1, 0.5, 0.9};
  constexpr int kIterations = 4;
  double least = dot(rest_, rest_);
  const double all = least;
  Physics best = without_;
  for (const double share : kShares) {
    Physics start = without_;
    for (const Draw& draw : rival.draws)
      start[moved_by_fit(draw.parameter)] = start_of(draw, share);
    const double cost = linear_cost(rival, start);
    if (cost < least) least = cost, best = start;
  }
  // A rival that is distant even with free sizes needs no fit.
  constexpr double kFarOff = 0.3;
  const double enough = 20 * kDistinguishable;
  if (least > kFarOff * all && 0.5 * least > enough) return 0.5 * least;
  const Fit fitted = fit([&](const Physics& physics) { return left(physics); },
                         fitted_parameters(rival), best, kIterations);
  return 0.5 * std::min(fitted.cost, all);
}

// Every size of the effect is also a size of the rival: the rival contains the effect.
bool is_nested(const Effect& effect, const Effect& rival) {
  const auto has = [&](const Draw& wanted) {
    return std::any_of(rival.draws.begin(), rival.draws.end(), [&](const Draw& draw) {
      return draw.is_size && draw.parameter == wanted.parameter;
    });
  };
  return std::all_of(effect.draws.begin(), effect.draws.end(),
                     [&](const Draw& draw) { return !draw.is_size || has(draw); });
}

}  // namespace

std::vector<Parameter> fitted_parameters(const Effect& effect) {
  std::vector<Parameter> parameters;
  for (const Draw& draw : effect.draws) {
    const bool jumps =
        draw.parameter == kForceStep || draw.parameter == kDropout || draw.parameter == kDamageTime;
    if (!jumps) parameters.push_back(moved_by_fit(draw.parameter));
  }
  return parameters;
}

EffectTruth truth_of(const TrialCase& trial, const Effect& effect, bool with_rivals) {
  const Rivalry rivalry{trial, effect};
  EffectTruth truth;
  truth.energy = 0.5 * dot(rivalry.of_effect(), rivalry.of_effect());
  truth.information = 0.5 * dot(rivalry.rest(), rivalry.rest());
  truth.of_effect = place_of(rivalry.of_effect(), rivalry.record());
  truth.of_rest = place_of(rivalry.rest(), rivalry.record());
  if (!with_rivals) return truth;
  for (const Effect& rival : effects()) {
    const bool can_be = rival.home == Home::Library && rival.relation == effect.relation &&
                        rival.name != effect.name && rival.name != "quantisation";
    if (can_be)
      truth.separations.push_back(
          {rival.name, rivalry.separation_from(rival), is_nested(effect, rival)});
  }
  std::sort(truth.separations.begin(), truth.separations.end(),
            [](const Separation& a, const Separation& b) { return a.nats < b.nats; });
  return truth;
}

}  // namespace trial

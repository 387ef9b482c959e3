// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/bearings.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::plant {
namespace {

constexpr double kFarAway = 0.2;  // beyond every yield displacement [m]
constexpr double kProbe = 1e-3;   // [m]

// After a slow way to a large displacement.
double post_yield_stiffness(const sim::Bearing& bearing) {
  constexpr int kSteps = 400;
  constexpr double kStep = 0.01;  // [s]
  sim::BearingRun run{bearing, kStep};
  const auto force_at = [&](double u) {
    return run.advance({u, 0}, Eigen::Vector2d::Zero(), bearing.axial_load)[0];
  };
  double force = 0;
  for (int i = 1; i <= kSteps; ++i) force = force_at(kFarAway * i / kSteps);
  return (force_at(kFarAway + kProbe) - force) / kProbe;
}

}  // namespace

BearingSet BearingSet::all_of(const sim::Bearing& bearing, std::size_t count) {
  BearingSet set;
  set.kinds = {bearing};
  set.kind_of.assign(count, 0);
  return set;
}

std::vector<BearingStiffness> stiffness_of(const BearingSet& bearings) {
  std::vector<BearingStiffness> of_kinds;
  for (const auto& kind : bearings.kinds) {
    const double initial = sim::initial_stiffness(kind);
    // A rigid body on bearings must still have a stiffness, as on sliders.
    constexpr double kLeastShare = 1e-3;
    const double after = std::clamp(post_yield_stiffness(kind), kLeastShare * initial, initial);
    of_kinds.push_back({{initial, initial, bearings.vertical_stiffness},
                        {after, after, bearings.vertical_stiffness}});
  }
  std::vector<BearingStiffness> result;
  for (std::size_t i = 0; i < bearings.kind_of.size(); ++i) {
    if (bearings.kind_of[i] >= of_kinds.size())
      throw Error{fmt::format("bearing {} is of kind {}, but there are {} kinds", i + 1,
                              bearings.kind_of[i] + 1, of_kinds.size())};
    result.push_back(of_kinds[bearings.kind_of[i]]);
  }
  return result;
}

SparseMatrix on_springs(const Structure& structure, const BearingSet& bearings,
                        std::array<double, kDirections> BearingStiffness::*springs) {
  std::vector<std::array<double, kDirections>> chosen;
  for (const auto& bearing : stiffness_of(bearings)) {
    chosen.push_back(bearing.*springs);
    for (double& spring : chosen.back()) spring *= bearings.stands_for;
  }
  return structure.on_springs(chosen);
}

BearingField::BearingField(const BearingSet& bearings, const VectorXd& weights, double time_step,
                           double damping_time)
    : kind_of_{bearings.kind_of},
      has_lifted_(kind_of_.size(), 0),
      weights_{weights},
      vertical_stiffness_{bearings.vertical_stiffness},
      tension_share_{bearings.tension_share},
      stands_for_{bearings.stands_for},
      damping_time_{damping_time},
      time_step_{time_step},
      least_{weights.minCoeff()},
      largest_{weights.maxCoeff()} {
  loads_ = {least_, largest_, 0};
  for (const auto& kind : bearings.kinds) {
    sim::require_given_load(kind);
    kinds_.emplace_back(kind.terms, time_step);
    temperatures_.push_back(kind.temperature);
  }
  const auto springs = stiffness_of(bearings);
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    first_state_.push_back(states_.size());
    states_.resize(states_.size() + kinds_[kind_of_[i]].states());
    stiffness_.push_back(springs[i].initial[0]);
  }
}

void BearingField::advance(const MatrixXd& motion, std::size_t tested,
                           VectorXd& correction) noexcept {
  time_ += time_step_;
  loads_ = {compression(0, motion(2, 0)), compression(0, motion(2, 0)), 0};
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    const auto row = static_cast<Index>(kDirections * i);
    const double load = compression(i, motion(row + 2, 0));
    loads_.least = std::min(loads_.least, load);
    loads_.largest = std::max(loads_.largest, load);
    if (load < 0) {
      has_lifted_[i] = 1;
      ++loads_.lifted;
    }
    // Up is positive: a lifted bearing pulls down less than k u + a₁ k v.
    const double carried = load - damping_time_ * vertical_stiffness_ * motion(row + 2, 1);
    correction[row + 2] = carried < 0 ? carried * (1 - tension_share_) : 0;
    if (i == tested) {
      correction[row] = correction[row + 1] = 0;
      continue;
    }
    const sim::Composition& kind = kinds_[kind_of_[i]];
    sim::Quantities<double> q;
    q.time = time_;
    q.displacement = {motion(row, 0), motion(row + 1, 0)};
    q.velocity = {motion(row, 1), motion(row + 1, 1)};
    q.axial_load = std::max(load, 0.0);
    q.temperature = temperatures_[kind_of_[i]];
    kind.advance(std::span{states_}.subspan(first_state_[i], kind.states()), q);
    for (Index k = 0; k < 2; ++k)
      correction[row + k] =
          q.force[static_cast<std::size_t>(k)] -
          stiffness_[i] * (motion(row + k, 0) + damping_time_ * motion(row + k, 1));
  }
  least_ = std::min(least_, loads_.least);
  largest_ = std::max(largest_, loads_.largest);
}

void BearingField::forces(const MatrixXd& motion, const VectorXd& correction,
                          VectorXd& forces) const noexcept {
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    const auto row = static_cast<Index>(kDirections * i);
    for (Index k = row; k < row + 2; ++k)
      forces[k] = correction[k] + stiffness_[i] * (motion(k, 0) + damping_time_ * motion(k, 1));
    forces[row + 2] = correction[row + 2] + vertical_stiffness_ * motion(row + 2, 0);
  }
}

void BearingField::damping(const MatrixXd& motion, VectorXd& forces) const noexcept {
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    const auto row = static_cast<Index>(kDirections * i);
    for (Index k = row; k < row + 2; ++k) forces[k] = damping_time_ * stiffness_[i] * motion(k, 1);
    forces[row + 2] = 0;
  }
}

double BearingField::strain(const MatrixXd& motion) const noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    const auto row = static_cast<Index>(kDirections * i);
    sum += stiffness_[i] * motion.col(0).segment<2>(row).squaredNorm() +
           vertical_stiffness_ * motion(row + 2, 0) * motion(row + 2, 0);
  }
  return sum / 2;
}

std::size_t BearingField::lifted() const {
  return static_cast<std::size_t>(std::count(has_lifted_.begin(), has_lifted_.end(), 1));
}

}  // namespace rths::plant

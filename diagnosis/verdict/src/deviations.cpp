// SPDX-License-Identifier: Apache-2.0
#include "deviations.hpp"

#include <algorithm>
#include <cmath>

#include <rths/core/axis.hpp>
#include <rths/maths/decompositions.hpp>

#include "improved.hpp"

namespace rths::diagnosis {
namespace {

// A with A Aᵀ = covariance, one column for each direction. Scaled, since units differ.
MatrixXd square_root(const MatrixXd& covariance) {
  const VectorXd deviation = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const auto unit = deviation.cwiseInverse().asDiagonal();
  const maths::Modes modes = maths::symmetric_modes(unit * covariance * unit);
  return deviation.asDiagonal() * modes.vectors * modes.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

Hypothesis moved(Hypothesis named, const std::vector<Index>& own, const VectorXd& by) {
  for (std::size_t i = 0; i < own.size(); ++i) {
    const auto& free = named.free[static_cast<std::size_t>(own[i])];
    double& value = named.values[own[i]];
    value = std::clamp(value + by[static_cast<Index>(i)], free.low, free.high);
  }
  return named;
}

// The improved model with other values of one relation.
std::string fragment_with(const AllFindings& all, const RelationFindings& changed,
                          const Hypothesis& named) {
  std::string text;
  for (const auto& found : all)
    text += found.get() == &changed ? fragment_of(*found, named) : fragment_of(*found);
  return text;
}

const RecordScore* score_of(const Evaluation& evaluation, const std::string& record) {
  for (const auto& score : evaluation.fit)
    if (score.record == record) return &score;
  return nullptr;
}

// Of the residual's amplitude, beyond the noise.
double share_beyond_noise(const RecordScore* score) {
  if (score == nullptr || !std::isfinite(score->noise_floor) || !(score->nrmse_after > 0)) return 1;
  const double noise = score->noise_floor / score->nrmse_after;
  return std::sqrt(std::max(0.0, 1 - noise * noise));
}

}  // namespace

Covariances covariances_of(const AllFindings& all) {
  Covariances covariances;
  for (const auto& found : all)
    if (found->is_named()) covariances[found.get()] = covariance_of(*found);
  return covariances;
}

std::vector<std::string> deviations_of(const AllFindings& all, const Covariances& covariances) {
  std::vector<std::string> deviations;
  for (const auto& found : all) {
    const auto covariance = covariances.find(found.get());
    const Hypothesis& named = found->selection.named;
    const auto own = specimen_parameters(named);
    if (covariance == covariances.end() || own.empty()) continue;
    const MatrixXd root = square_root(covariance->second(own, own));
    for (Index i = 0; i < root.cols(); ++i)
      for (const double sense : {1.0, -1.0})
        deviations.push_back(fragment_with(all, *found, moved(named, own, sense * root.col(i))));
  }
  return deviations;
}

ForceRemainder remainder_of(const Evaluation& evaluation) {
  ForceRemainder remainder;
  if (evaluation.traces.empty()) return remainder;
  const std::string& record = evaluation.traces.front().record;
  const double share = share_beyond_noise(score_of(evaluation, record));
  for (const auto& trace : evaluation.traces)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const bool is_force = trace.channel == std::string{"force."} + name_of(kHorizontal[axis]);
      if (!is_force || trace.record != record || trace.time.size() < 2) continue;
      remainder.time_step = trace.time[1] - trace.time[0];
      for (std::size_t i = 0; i < trace.measured.size(); ++i)
        remainder.force[axis].push_back(share * (trace.measured[i] - trace.after[i]));
    }
  return remainder;
}

}  // namespace rths::diagnosis

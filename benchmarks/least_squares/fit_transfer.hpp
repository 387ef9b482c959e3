// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>

#include <rths/identification/least_squares.hpp>
#include <rths/sim/axis_transfer.hpp>

namespace rths::benchmarks {

/// Parameters of a transfer system as `budget::identify_transfer` fits them.
struct Fitted {
  double sim::AxisTransfer::*member;
  double start, low, high, scale;
};
inline constexpr Fitted kFitted[] = {{&sim::AxisTransfer::gain, 24, 1, 500, 20},
                                     {&sim::AxisTransfer::transport_delay, 0.006, 0, 0.1, 0.002},
                                     {&sim::AxisTransfer::valve_frequency, 15, 1, 100, 10},
                                     {&sim::AxisTransfer::valve_damping, 0.7, 0.1, 5, 1},
                                     {&sim::AxisTransfer::dead_band, 1e-4, 0, 0.02, 5e-4},
                                     {&sim::AxisTransfer::pressure_feedback, 1e-9, 0, 1e-6, 1e-8},
                                     {&sim::AxisTransfer::pressure_washout, 0.3, 0, 20, 1},
                                     {&sim::AxisTransfer::compliance, 1e-9, 1e-11, 1e-7, 1e-9},
                                     {&sim::AxisTransfer::supply_force, 8e6, 1e3, 1e9, 1e7},
                                     {&sim::AxisTransfer::leakage, 1e-11, 0, 1e-6, 1e-9}};

inline bool residual_at(const sim::TransferRecord& record, const Eigen::VectorXd& parameters,
                        Eigen::VectorXd& residual) {
  sim::AxisTransfer system;
  for (std::size_t i = 0; i < std::size(kFitted); ++i)
    system.*kFitted[i].member = parameters[static_cast<Eigen::Index>(i)];
  const auto x = sim::predicted(system, record);
  residual.resize(static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i)
    residual[static_cast<Eigen::Index>(i)] = 1e4 * (record.displacement[i] - x[i]);  // 0.1 mm
  return residual.allFinite();
}

inline diagnosis::FitProblem transfer_problem(const sim::TransferRecord& record) {
  constexpr auto kCount = static_cast<Eigen::Index>(std::size(kFitted));
  diagnosis::FitProblem problem;
  problem.rows = static_cast<Eigen::Index>(record.displacement.size());
  problem.start = problem.low = problem.high = problem.scale = Eigen::VectorXd(kCount);
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const Fitted& one = kFitted[i];
    problem.start[i] = one.start;
    problem.low[i] = one.low;
    problem.high[i] = one.high;
    problem.scale[i] = one.scale;
  }
  problem.residuals = [&record](const Eigen::VectorXd& parameters, Eigen::VectorXd& residual,
                                Eigen::MatrixXd* jacobian) {
    if (!residual_at(record, parameters, residual)) return false;
    if (jacobian == nullptr) return true;
    jacobian->resize(residual.size(), parameters.size());
    Eigen::VectorXd other;
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const double size = 1e-4 * std::max(kFitted[i].scale, std::abs(parameters[i]));
      const double step = parameters[i] + size > kFitted[i].high ? -size : size;
      Eigen::VectorXd beside = parameters;
      beside[i] += step;
      if (!residual_at(record, beside, other)) return false;
      jacobian->col(i) = (other - residual) / step;
    }
    return true;
  };
  return problem;
}

}  // namespace rths::benchmarks

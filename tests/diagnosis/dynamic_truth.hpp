// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "dynamic_case.hpp"

namespace rths::diagnosis::test {

/// A chain of masses on springs, the first on the ground, pushed at one mass, with one thing in it
/// that its simulation does not know. Written apart from the library.
struct Truth {
  Eigen::VectorXd masses, stiffness, damping;
  Eigen::Index pushed = 0;
  /// Force between the ends of a spring beside the linear one, by spring: of displacement,
  /// velocity and a memory that it may move once per step.
  std::function<double(Eigen::Index, double, double)> spring;
  /// d(memory)/dt of one internal variable of spring `hysteretic`, which adds `gain` times it.
  std::function<double(double memory, double velocity)> memory_rate;
  Eigen::Index hysteretic = 0;
  double gain = 0;
  double gap = 0;  ///< of the joint that spring `hysteretic` is held by: play
  /// What becomes of the input: of time and the signal.
  std::function<double(const std::function<double(double)>&, double)> input;
  double input_lag = 0;  ///< of first order [s]
};

/// Displacements by sample, one column for each mass.
[[nodiscard]] Eigen::MatrixXd motion_of(const Truth& truth, const std::vector<double>& input,
                                        double time_step);

}  // namespace rths::diagnosis::test

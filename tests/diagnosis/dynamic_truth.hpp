// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "dynamic_case.hpp"

namespace rths::diagnosis::test_support {

/// A chain of masses on springs. The first is on the ground, and a force acts on one mass. The
/// chain has one effect that its simulation leaves out. Independent of the library.
struct Truth {
  Eigen::VectorXd masses, stiffness, damping;
  Eigen::Index pushed = 0;
  /// Force of a spring besides the linear one, by index, displacement and velocity.
  std::function<double(Eigen::Index, double, double)> spring;
  /// d(memory)/dt of an internal variable of spring `hysteretic`. It adds the force `gain` ×
  /// memory.
  std::function<double(double memory, double velocity)> memory_rate;
  Eigen::Index hysteretic = 0;
  double gain = 0;
  std::function<double(double)> grip;  ///< a factor of that force, by the spring's displacement
  double gap = 0;                      ///< play of the joint that holds spring `hysteretic`
  /// The input after an effect, by signal and time.
  std::function<double(const std::function<double(double)>&, double)> input;
  double input_lag = 0;  ///< time constant of a first-order lag [s]
};

/// Displacements by sample, one column for each mass.
[[nodiscard]] Eigen::MatrixXd motion_of(const Truth& truth, const std::vector<double>& input,
                                        double time_step);

}  // namespace rths::diagnosis::test_support

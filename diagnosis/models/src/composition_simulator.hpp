// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "motion_drive.hpp"

namespace rths::diagnosis {

/// The predicted quantity of a composition.
enum class Predicted { Force, Displacement, Acceleration };

/// Runs a composition along a drive. Derivatives are differences.
class CompositionSimulator final : public Simulator {
 public:
  CompositionSimulator(const Hypothesis& hypothesis, const MotionDrive& drive, Predicted predicted,
                       const std::vector<std::size_t>& axes);

  [[nodiscard]] bool run(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& wanted,
                         Eigen::MatrixXd& prediction,
                         std::vector<Eigen::MatrixXd>& derivatives) const override;

 private:
  /// The predicted quantity at every step of the model, a column for each axis.
  /// @returns false if it is not finite
  [[nodiscard]] bool predict(const Eigen::VectorXd& values,
                             Eigen::Ref<Eigen::MatrixXd> output) const;
  void run_first(const std::vector<double>& parameters, Axes& output) const;
  void run_second(const std::vector<double>& parameters, Axes& force) const;
  /// The first half's output. It runs only if its parameters have changed since the last call.
  [[nodiscard]] const Axes& specimen(const std::vector<double>& parameters) const;

  struct ParameterIndex {
    std::size_t half, parameter;
  };

  std::array<sim::Composition, 2> compositions_;  ///< 0: specimen; 1: machine and sensors
  int substeps_ = 1;                              ///< of a step of the model, for the specimen
  std::string specimen_signature_;                ///< the first half's terms, but no parameters
  const MotionDrive& drive_;
  Predicted predicted_;
  std::vector<std::size_t> axes_;
  std::vector<FreeParameter> free_;
  std::vector<std::vector<ParameterIndex>> indices_;  ///< of each free parameter
};

}  // namespace rths::diagnosis

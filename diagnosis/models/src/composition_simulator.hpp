// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "motion_drive.hpp"

namespace rths::diagnosis {

/// The predicted quantity of a composition.
enum class Predicted { Force, Displacement, Acceleration };

/// Runs a composition along a drive. Derivatives are differences.
class CompositionSimulator final : public Simulator {
 public:
  CompositionSimulator(const Hypothesis& hypothesis, const MotionDrive& drive, Predicted predicted,
                       const std::vector<std::size_t>& axes);

  [[nodiscard]] bool run(const VectorXd& values, const std::vector<Index>& wanted,
                         MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const override;
  void keep(const VectorXd& values) override;
  void share(const Simulator& other) override;

 private:
  /// Parameters of both halves.
  using Parameters = std::array<std::vector<double>, 2>;
  /// Output of the first half, which most changes of a hypothesis leave as it is.
  struct Specimen {
    std::vector<double> parameters;
    Axes output;
  };

  [[nodiscard]] Parameters parameters_at(const VectorXd& values) const;
  /// Runs the first half, unless its parameters are those of a known output.
  [[nodiscard]] std::shared_ptr<const Specimen> specimen(
      const std::vector<double>& parameters, const std::shared_ptr<const Specimen>& known) const;
  /// The predicted quantity at every step of the model, a column for each axis.
  /// @returns false if it is not finite
  [[nodiscard]] bool predict(const Parameters& parameters, const Specimen& specimen,
                             Eigen::Ref<MatrixXd> output) const;
  void run_first(const std::vector<double>& parameters, Axes& output) const;
  void run_second(const std::vector<double>& parameters, Axes& force) const;

  struct ParameterIndex {
    std::size_t half, parameter;
  };

  std::array<sim::Composition, 2> compositions_;  ///< 0: specimen; 1: machine and sensors
  int substeps_ = 1;                              ///< of a step of the model, for the specimen
  std::string specimen_signature_;                ///< the first half's terms, but no parameters
  std::shared_ptr<const Specimen> kept_;          ///< null: nothing is kept
  const MotionDrive& drive_;
  Predicted predicted_;
  std::vector<std::size_t> axes_;
  std::vector<FreeParameter> free_;
  std::vector<std::vector<ParameterIndex>> indices_;  ///< of each free parameter
};

}  // namespace rths::diagnosis

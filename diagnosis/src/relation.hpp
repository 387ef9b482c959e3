// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rths/diagnosis/case.hpp>

#include "hypothesis.hpp"

namespace rths::diagnosis {

/// One record as a relation looks at it: what is predicted, at the rate at which it is compared,
/// and the state of the tested part at those instants. What drives the prediction is the
/// relation's.
class Drive {
 public:
  virtual ~Drive() = default;

  double start = 0, time_step = 0;  ///< of the rows [s]
  Eigen::MatrixXd measured;         ///< rows × outputs, through the filter that predictions take
  /// What the residual is mapped over: rows × outputs, empty if unknown [m], [m/s].
  Eigen::MatrixXd displacement, velocity;
  std::vector<std::pair<std::string, Eigen::VectorXd>> states;  ///< "axial load [N]", by row
  Eigen::Index first_row = 0;  ///< compared from here on: before it the state is unknown

  [[nodiscard]] Eigen::Index rows() const { return measured.rows(); }
};

/// A hypothesis made ready to run on one record.
class Simulator {
 public:
  virtual ~Simulator() = default;
  /// Predicts the outputs.
  /// @param values  of the hypothesis' free parameters
  /// @param wanted  free parameters that derivatives are wanted for
  /// @param prediction  rows × outputs
  /// @param derivatives  one for each wanted parameter, rows × outputs
  /// @returns false if there is no prediction at these values (it diverges)
  [[nodiscard]] virtual bool run(const Eigen::VectorXd& values,
                                 const std::vector<Eigen::Index>& wanted,
                                 Eigen::MatrixXd& prediction,
                                 std::vector<Eigen::MatrixXd>& derivatives) const = 0;
};

/// An equation that the channels of a recording must satisfy if the model holds, which is part of
/// the laboratory and can be checked by itself: motion → force, command → motion, input → output.
class Relation {
 public:
  virtual ~Relation() = default;

  [[nodiscard]] virtual const std::string& name() const = 0;  ///< "motion to force"
  [[nodiscard]] virtual Part part() const = 0;                ///< guilty if no term is named
  /// Roles of what is predicted: "force.long", and their units.
  [[nodiscard]] virtual const std::vector<std::pair<std::string, std::string>>& outputs() const = 0;
  /// Whether each record and output has an offset of its own that nobody minds.
  [[nodiscard]] virtual bool has_free_offsets() const = 0;
  [[nodiscard]] virtual const Hypothesis& base() const = 0;  ///< what the simulation assumed
  /// What it may have left out, with what was found already. Scales and starts come from what the
  /// records hold.
  [[nodiscard]] virtual std::vector<Candidate> candidates() const = 0;
  /// Roles of the channels that a laboratory may choose; none: the prediction is given as data.
  [[nodiscard]] virtual std::vector<std::string> drivers() const = 0;

  /// @throws Error if the record lacks a channel that the relation needs
  [[nodiscard]] virtual std::unique_ptr<Drive> prepare(const Record& record) const = 0;
  /// The drive as it would be had the sensors' noise been larger by this, and by this turned round
  /// in time: noise is as likely to come earlier or later.
  /// @param noise  a record of noise alone: those channels of the drive's record that are noisy
  [[nodiscard]] virtual std::vector<std::unique_ptr<Drive>> disturbed(
      const Drive& drive, const Record& noise) const = 0;
  /// The drive must outlive the simulator. @throws Error if terms or names do not fit the model
  [[nodiscard]] virtual std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                                             const Drive& drive) const = 0;
};

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <rths/identification/hypothesis.hpp>
#include <rths/identification/record.hpp>
#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// Name and unit of the quantity over which a residual is mapped; its rate has the unit per second.
struct StateName {
  std::string name, unit;  ///< "displacement", "m"
};

/// One record, prepared for a relation: the measured outputs at the rate of comparison, and the
/// state of the tested part at those instants. Derived classes hold the signals that drive the
/// prediction.
class Drive {
 public:
  virtual ~Drive() = default;

  double start = 0, time_step = 0;  ///< of the rows [s]; without time: the first row, and 1
  bool has_time = true;             ///< as the record's
  MatrixXd measured;                ///< rows × outputs, filtered as predictions are
  /// What anchors the prediction to the user's own simulation: added to it, rows × outputs; empty:
  /// nothing.
  MatrixXd anchor;
  /// States over which the residual is mapped: rows × outputs, empty if unknown [m], [m/s].
  MatrixXd displacement, velocity;
  std::vector<StateName> state_names;  ///< of `displacement`, by output
  double cutoff = 0;  ///< of the low-pass filter on measurement and prediction [Hz]; 0: none
  std::vector<std::pair<std::string, VectorXd>> states;  ///< "axial load [N]", by row
  ArrayXd present;      ///< by row: 0 near gaps of the record, else 1; empty: no gaps
  Index first_row = 0;  ///< first compared row: before it the state is unknown

  [[nodiscard]] Index rows() const { return measured.rows(); }
  /// By row: 1 if it is compared, else 0.
  [[nodiscard]] ArrayXd compared() const;
  /// The compared rows of a signal.
  [[nodiscard]] MatrixXd compared_rows(const MatrixXd& signal) const;
};

/// A hypothesis, prepared to run on one record.
class Simulator {
 public:
  virtual ~Simulator() = default;
  /// Predicts the outputs.
  /// @param values  of the hypothesis' free parameters
  /// @param wanted  free parameters whose derivatives are computed
  /// @param prediction  rows × outputs
  /// @param derivatives  one for each wanted parameter, rows × outputs
  /// @returns false if there is no prediction at these values (it diverges)
  [[nodiscard]] virtual bool run(const VectorXd& values, const std::vector<Index>& wanted,
                                 MatrixXd& prediction,
                                 std::vector<MatrixXd>& derivatives) const = 0;
  /// Computes once what runs near these values have in common. Changes no prediction.
  virtual void keep(const VectorXd& /*values*/) {}
  /// Uses what another simulator of the same relation and drive keeps.
  virtual void share(const Simulator& /*other*/) {}
  /// Work of a run for each row of its drive, in steps of a composition.
  [[nodiscard]] virtual int work_per_row() const { return 1; }
};

/// A term of free shape: values at knots of a state.
struct FreeForm {
  Candidate term;             ///< its free parameters are the values
  std::string label;          ///< of the state: "velocity [m/s]"
  std::vector<double> knots;  ///< of the state
};

/// An equation that the channels of a recording satisfy if the model is right. Each relation covers
/// one part of the laboratory and is checked separately: motion → force, command → motion,
/// input → output.
class Relation {
 public:
  virtual ~Relation() = default;

  [[nodiscard]] virtual const std::string& name() const = 0;  ///< "motion to force"
  [[nodiscard]] virtual Part part() const = 0;                ///< blamed if no term is named
  /// Roles of the predicted channels, "force.long", and their units.
  [[nodiscard]] virtual const std::vector<std::pair<std::string, std::string>>& outputs() const = 0;
  /// Whether each record and output may have an offset of its own, which is not an error.
  [[nodiscard]] virtual bool has_free_offsets() const = 0;
  [[nodiscard]] virtual const Hypothesis& base() const = 0;  ///< assumptions of the simulation
  /// Effects that a model may lack: the base, or an extension of it. Scales and starting values
  /// come from the records.
  [[nodiscard]] virtual std::vector<Candidate> candidates(const Hypothesis& model) const = 0;
  /// Terms that describe an effect without a name, acting on the predicted state. None: the states
  /// are measured and drive the prediction, so that effects are regressed on them directly.
  /// @param model  determines the range of the states
  [[nodiscard]] virtual std::vector<FreeForm> forms(const Hypothesis& /*model*/) const {
    return {};
  }
  /// Whether the inputs alone determine the prediction, so that no measured state enters it.
  [[nodiscard]] virtual bool runs_freely() const { return false; }
  /// Roles of the channels that a laboratory can choose; none: the prediction is given as data.
  [[nodiscard]] virtual std::vector<std::string> drivers() const = 0;

  /// What a verdict says about the model, besides the channels: "The simulation ran 312 times."
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }

  /// @throws Error if the record lacks a channel that the relation needs
  [[nodiscard]] virtual std::unique_ptr<Drive> prepare(const Record& record) const = 0;
  /// The drive with additional noise, and with the same noise reversed in time, which is equally
  /// likely.
  /// @param noise  a record of noise alone, with the noisy channels of the drive's record
  [[nodiscard]] virtual std::vector<std::unique_ptr<Drive>> disturbed(
      const Drive& drive, const Record& noise) const = 0;
  /// The drive must outlive the simulator. @throws Error if terms or names do not fit the model
  [[nodiscard]] virtual std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                                             const Drive& drive) const = 0;
};

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <rths/identification/problem.hpp>
#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// A relation whose prediction is linear in the free parameters: Σ value × signal. So every
/// statistic of it has a closed form. The signal of a parameter is the channel "input.NAME.OUTPUT"
/// of the record; it is zero where there is none.
class LinearRelation : public Relation {
 public:
  /// @param units  of the outputs "output.0", "output.1", …
  explicit LinearRelation(std::vector<std::string> units = {"N"});

  Hypothesis stated;                   ///< the base: no parameters, unless set
  std::vector<Candidate> known;        ///< all candidates
  std::vector<double> deviation;       ///< of the noise, by output; 1 unless set
  double motion_noise = 0;             ///< deviation of the noise of the signals
  double offset_noise = 0;             ///< deviation of the noise's offset
  bool offsets = false;                ///< free, of each record and output
  std::vector<std::string> driven_by;  ///< roles of the drivers
  std::function<void()> fail;          ///< called before each prediction
  bool has_prediction = true;

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Part part() const override { return Part::Structure; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& outputs() const override {
    return outputs_;
  }
  [[nodiscard]] bool has_free_offsets() const override { return offsets; }
  [[nodiscard]] const Hypothesis& base() const override { return stated; }
  [[nodiscard]] std::vector<Candidate> candidates(const Hypothesis& /*model*/) const override {
    return known;
  }
  [[nodiscard]] std::vector<std::string> drivers() const override { return driven_by; }
  /// Rows in gaps of the record are not present. "auxiliary.displacement" and "auxiliary.velocity"
  /// are states of all outputs. The first row is compared from the end of `settle` on.
  [[nodiscard]] std::unique_ptr<Drive> prepare(const Record& record) const override;
  /// Noise of exactly the known sizes, which has no low frequencies: ± deviation, row by row, and
  /// that of the signals two rows by two rows. Its offset is ± offset_noise.
  [[nodiscard]] std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                              const Record& noise) const override;
  [[nodiscard]] std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                                     const Drive& drive) const override;

 private:
  std::string name_ = "linear";
  std::vector<std::pair<std::string, std::string>> outputs_;
};

using Inputs = std::map<std::string, Eigen::MatrixXd>;  ///< by parameter: rows × outputs

[[nodiscard]] Record linear_record(const std::string& name, Use use, double time_step,
                                   const Eigen::MatrixXd& measured, const Inputs& inputs);

/// A problem of all records. Records and relation must outlive it.
[[nodiscard]] Problem linear_problem(const LinearRelation& relation,
                                     const std::vector<Record>& records);

/// √2 sin(2π cycles i/rows): mean 0, mean square 1, orthogonal to those of other whole cycles.
[[nodiscard]] Eigen::VectorXd sine_of(int cycles, Eigen::Index rows);
/// White Gaussian noise of variance 1.
[[nodiscard]] Eigen::MatrixXd gauss(Eigen::Index rows, Eigen::Index outputs, unsigned seed);

/// A parameter without effect at zero.
[[nodiscard]] FreeParameter size_parameter(const std::string& name, double low = -1e3,
                                           double high = 1e3);
/// A viscous friction that is named as its term; its size is the parameter "TERM.coefficient".
[[nodiscard]] Candidate friction(const std::string& term, double low = -1e3);
/// A hypothesis without terms, of these parameters at these values.
[[nodiscard]] Hypothesis linear_model(const std::vector<std::string>& parameters,
                                      const std::vector<double>& values);
/// All rows of some records.
[[nodiscard]] Fold whole(const std::vector<std::size_t>& records);
/// The first record fits, the second scores.
[[nodiscard]] Folds two_records();

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/foreign/runs.hpp>

#include "dynamic_model.hpp"

namespace rths::diagnosis {

/// The user's own simulation: what it takes and returns, and the runs that were made of it.
class ForeignModel {
 public:
  /// @throws Error file:line:column if the table describes no such simulation, or if it cannot run
  ///         @setup
  explicit ForeignModel(const Config& table);

  [[nodiscard]] const std::vector<std::string>& inputs() const { return inputs_; }    ///< roles
  [[nodiscard]] const std::vector<std::string>& outputs() const { return outputs_; }  ///< roles
  [[nodiscard]] const std::vector<ModelParameter>& parameters() const { return parameters_; }

  /// Runs at the stated parameters, twice for the first record.
  /// @returns the record with a channel `predicted.<role>` for each output
  /// @throws Error if a run fails, or if two runs differ   @setup
  [[nodiscard]] Record predicted(const Record& record, bool is_first) const;

  /// Results of several runs. @param wanted  with signals in the order of `inputs()`
  [[nodiscard]] std::vector<const foreign::RunOutputs*> results(
      const std::vector<foreign::RunInputs>& wanted) const {
    return runs_->results(wanted);
  }
  /// "The simulation ran 312 times, of 2000 that are allowed."
  [[nodiscard]] std::string note() const;

 private:
  [[nodiscard]] foreign::RunInputs stated_run(const Record& record) const;

  std::vector<std::string> inputs_, outputs_;
  std::vector<ModelParameter> parameters_;
  std::unique_ptr<foreign::Runs> runs_;
};

/// The model of a foreign simulation: its outputs as if they were recorded, terms at its inputs and
/// outputs and terms added to them.
/// @param record  with the channels that it predicts
[[nodiscard]] DynamicModel read_foreign(const Config& table, const ForeignModel& foreign,
                                        const Record& record);

}  // namespace rths::diagnosis

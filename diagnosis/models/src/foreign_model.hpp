// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/foreign/runs.hpp>

#include "dynamic_model.hpp"
#include "foreign_reading.hpp"

namespace rths::diagnosis {

/// The user's own simulation: what it takes and returns, and the runs that were made of it.
class ForeignModel {
 public:
  /// @throws Error file:line:column if the table describes no such simulation, or if it cannot run
  ///         @setup
  explicit ForeignModel(const Model& model);

  [[nodiscard]] const std::vector<std::string>& inputs() const { return read_.inputs; }  ///< roles
  [[nodiscard]] const std::vector<std::string>& outputs() const {
    return read_.outputs;
  }  ///< roles
  [[nodiscard]] const std::vector<ModelParameter>& parameters() const { return read_.parameters; }
  [[nodiscard]] const std::vector<ForeignPort>& ports() const { return read_.ports; }
  /// The channels that a run computes, in its order: predictions of the outputs, motions at ports.
  [[nodiscard]] std::vector<std::string> computed() const;
  /// The rest of the table: what all models of this project have.
  [[nodiscard]] const Config& rest() const { return read_.rest; }

  /// Runs at the stated parameters, twice for the first record.
  /// @returns the record with the computed channels
  /// @throws Error if a run fails, or if two runs differ   @setup
  [[nodiscard]] Record predicted(const Record& record, bool is_first) const;

  /// Results of several runs. @param wanted  with signals in the order of `inputs()`
  [[nodiscard]] std::vector<foreign::RunOutputs> results(
      const std::vector<foreign::RunInputs>& wanted) const {
    return runs_->results(wanted);
  }
  /// Growth of the steps of differences, by free parameter: kept from where one first moves.
  [[nodiscard]] std::optional<double> growth_of(const std::string& free) const {
    const auto known = growth_.find(free);
    return known == growth_.end() ? std::nullopt : std::optional{known->second};
  }
  void keep_growth(const std::string& free, double growth) const { growth_[free] = growth; }
  /// "The simulation ran 312 times, of 2000 that are allowed."
  [[nodiscard]] std::string note() const;

 private:
  [[nodiscard]] foreign::RunInputs stated_run(const Record& record) const;

  ForeignReading read_;
  std::unique_ptr<foreign::Runs> runs_;
  mutable std::map<std::string, double> growth_;
};

/// The model of a foreign simulation: its outputs as if they were recorded, terms at its inputs and
/// outputs, at its ports, and terms added to outputs.
/// @param record  with the channels that it predicts
[[nodiscard]] DynamicModel read_foreign(const ForeignModel& foreign, const Record& record);

}  // namespace rths::diagnosis

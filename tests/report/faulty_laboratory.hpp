// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rths/launch/run.hpp>
#include <rths/report/judgement.hpp>

namespace rths::report {

/// A fault between the machine and the ring. Words of the machine are changed after it has written
/// them, words of the controller before the machine reads them.
struct Fault {
  std::string word;  ///< "srmd.long.force.fbk"
  /// New value of the word. @param value  without the fault   @param other  of `other_word`
  /// @param since  time since the fault began [s]
  std::function<double(double value, double other, double since)> change;
  std::string other_word;  ///< whose value `change` receives; empty: none
};

/// An example of the laboratory, shortened, and without the safety layer, which would end a faulty
/// test.
[[nodiscard]] experiment::Experiment short_experiment(const std::string& example,
                                                      const experiment::Overrides& changes = {});

/// Runs an experiment in virtual time with faults in its machine.
/// @param from  start of the faults, since the run began [s]
void run_with(const experiment::Experiment& experiment, const std::vector<Fault>& faults,
              double from, const std::filesystem::path& recording);

/// As `run_with`. @returns the broken conditions
[[nodiscard]] std::vector<Broken> judge_with(const experiment::Experiment& experiment,
                                             const std::vector<Fault>& faults, double from);

/// A row of a recording; its values by name of the signal.
using Row = std::map<std::string, double>;
/// Copies a recording. @param edit  may change a row; false leaves it out
void copy(const std::filesystem::path& from, const std::filesystem::path& to,
          const std::function<bool(double time, Row& row)>& edit);

}  // namespace rths::report

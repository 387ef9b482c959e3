// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::launch {

/// Runs of experiments that contradict themselves, as a user would start them.
class ContraryRuns {
 public:
  ContraryRuns();

  /// A short test with the machine of the SRMD, or with a solver of the user's own and an ideal
  /// machine. @param sets  key=value; {files} is the folder of the records
  [[nodiscard]] test::Finished run(const std::string& experiment,
                                   const std::vector<std::string>& sets,
                                   const std::string& clock = "virtual") const;
  /// The command of such a run.
  [[nodiscard]] std::vector<std::string> command(const std::string& experiment,
                                                 const std::vector<std::string>& sets,
                                                 const std::string& clock) const;
  [[nodiscard]] const std::string& ring() const { return ring_; }

 private:
  void write_records() const;
  void write_experiments() const;

  test::TemporaryFolder folder_;
  std::string ring_;
};

}  // namespace rths::launch

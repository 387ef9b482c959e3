// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rths::foreign {

/// What one run of a simulation is given: inputs at equally spaced times, and parameters, both in
/// the order of the simulation's settings.
struct RunInputs {
  double start = 0, time_step = 0;  ///< of the rows [s]
  std::size_t rows = 0;
  std::vector<std::vector<double>> inputs;  ///< by input, by row
  std::vector<double> parameters;
};

/// What one run returned.
struct RunOutputs {
  std::vector<std::vector<double>> outputs;  ///< by output, at the rows of the inputs
  std::string trouble;  ///< why there are no outputs: "ended with exit code 2"; empty: none
};

/// Somebody else's simulation, run as it is.
class Simulation {
 public:
  virtual ~Simulation() = default;
  /// @throws Interrupted   @any_thread
  [[nodiscard]] virtual RunOutputs run(const RunInputs& inputs) const = 0;
};

}  // namespace rths::foreign

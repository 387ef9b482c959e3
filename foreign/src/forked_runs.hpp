// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <rths/foreign/simulation.hpp>

namespace rths::foreign {

/// A signal between its rows, linear or held. @param place  [rows]
[[nodiscard]] double value_at(const std::vector<double>& rows, double place, bool is_held);

/// Runs of one simulation in one fork of this process.
struct ForkedRuns {
  std::string title;        ///< of the simulation, for messages
  std::size_t outputs = 0;  ///< of each run
  double deadline = 60;     ///< of one run [s]
  /// @param results  by output, by row
  std::function<void(const RunInputs& inputs, double* results)> run;

  /// All have the same trouble if one of them fails.
  [[nodiscard]] std::vector<RunOutputs> results(std::span<const RunInputs* const> all) const;
};

/// A simulation whose runs are forks of this process. A fork costs more than most runs: several
/// share one, and if that fails, each is made alone.
class ForkedSimulation : public Simulation {
 public:
  [[nodiscard]] RunOutputs run(const RunInputs& inputs) const override;
  [[nodiscard]] std::vector<RunOutputs> run_each(
      std::span<const RunInputs* const> all) const override;
  [[nodiscard]] bool prefers_several() const override { return true; }

 private:
  [[nodiscard]] virtual std::vector<RunOutputs> run_forked_once(
      std::span<const RunInputs* const> all) const = 0;
};

}  // namespace rths::foreign

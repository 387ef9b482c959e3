// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rths::foreign {

/// Motion at a port: between the two points of a simulation that a force may join.
struct PortMotion {
  double time = 0, displacement = 0, velocity = 0;
};

/// Forces of one run at the ports of a simulation. They have a memory.
class PortForces {
 public:
  virtual ~PortForces() = default;
  /// @param port  in the order of the simulation's settings
  /// @returns the force against the displacement at the end of a step
  [[nodiscard]] virtual double next(std::size_t port, const PortMotion& motion) = 0;
};

/// A law of forces at ports.
struct PortLaw {
  std::string key;  ///< differs for different laws; empty: no forces
  std::function<std::unique_ptr<PortForces>(double time_step)> begin;
};

/// What one run of a simulation is given: inputs at equally spaced times, and parameters, both in
/// the order of the simulation's settings.
struct RunInputs {
  double start = 0, time_step = 0;  ///< of the rows [s]
  std::size_t rows = 0;
  std::vector<std::vector<double>> inputs;  ///< by input, by row
  std::vector<double> parameters;
  PortLaw law = {};  // NOLINT: designated initializers need it
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
  /// Several runs, one after the other.
  /// @throws Interrupted   @any_thread
  [[nodiscard]] virtual std::vector<RunOutputs> run_each(
      std::span<const RunInputs* const> all) const {
    std::vector<RunOutputs> results;
    for (const RunInputs* inputs : all) results.push_back(run(*inputs));
    return results;
  }
  /// Whether `run_each` takes less time than as many runs.
  [[nodiscard]] virtual bool prefers_several() const { return false; }
};

}  // namespace rths::foreign

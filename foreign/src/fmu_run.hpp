// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/fmi/fmu_calls.hpp>
#include <rths/foreign/fmu.hpp>

namespace rths::foreign {

/// An FMU with its variables found: how a run exchanges them.
struct FmuSetup {
  struct Port {
    std::optional<std::size_t> force;  ///< input that it changes, in `given`
    std::optional<std::size_t> state;  ///< in `states`
    std::size_t displacement = 0;      ///< in `motions`
    std::optional<std::size_t> velocity;
    std::optional<std::size_t> output;  ///< that is the state
  };

  fmi::ModelDescription description;
  std::filesystem::path folder, library;  ///< unpacked
  FmuSettings settings;
  fmi::Exchanges start;                     ///< values of `settings.start`
  fmi::Exchanges parameters;                ///< those of a run
  fmi::Exchanges given;                     ///< inputs, then inputs that only a port changes
  std::vector<double> rest;                 ///< of the latter without a force [SI]
  fmi::Exchanges outputs, motions, states;  ///< what is read: [SI]
  std::size_t motion_count = 0, state_count = 0;
  std::vector<Port> ports;

  [[nodiscard]] bool restarts() const { return state_count > 0; }
};

/// Steps of a run with rows of this interval [s].
[[nodiscard]] double step_of(const FmuSetup& setup, double interval);

/// Runs an FMU in this process.
/// @param is_restarted  it starts anew at each step, which only ports at states need
/// @param results  by output, by row
/// @throws Error if a call of the FMU fails, or an output is not finite
void run_fmu(FmuSetup setup, const RunInputs& inputs, bool is_restarted, double* results);

}  // namespace rths::foreign

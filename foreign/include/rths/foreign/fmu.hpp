// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <rths/foreign/simulation.hpp>

namespace rths::foreign {

/// Variables of an FMU between which a force may act. Exactly one of `force` and `state` is named.
struct FmuPort {
  std::string displacement;  ///< that the force opposes
  std::string velocity;      ///< empty: differences of the displacement
  std::string force;         ///< an input, from which the force is subtracted [N]
  /// A state, the velocity: the FMU starts anew at each step, where force × step is subtracted from
  /// it. The force is that of a unit mass [N/kg].
  std::string state;
};

/// A simulation that is a Functional Mock-up Unit for co-simulation.
struct FmuSettings {
  std::filesystem::path file;                            ///< .fmu, or a folder with its content
  std::vector<std::string> inputs, outputs, parameters;  ///< names of variables
  std::vector<std::pair<std::string, double>> start;     ///< of others, in the FMU's unit
  std::vector<FmuPort> ports;
  double step = 0;            ///< of communication [s]; 0: see make_fmu
  bool holds_inputs = false;  ///< each value until the next; otherwise linear between the rows
  double deadline = 60;       ///< of one run [s]
};

/// Each run is a process of its own, a fork of this one, in which the FMU is loaded. Inputs and
/// outputs are in SI, parameters in the FMU's unit. In a step the inputs are the means over it.
/// Outputs are read at the end of a step, with the inputs there. The time of the FMU starts at 0.
/// Without `step`, a step is the interval of the rows; for an FMU with a fixed step it is the
/// shortest multiple that divides the interval into at most 20, otherwise the fixed step. Between
/// the steps, outputs are interpolated linearly.
/// @throws Error if the FMU cannot be read or used, or lacks a variable   @setup
[[nodiscard]] std::unique_ptr<Simulation> make_fmu(FmuSettings settings);

}  // namespace rths::foreign

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/foreign/simulation.hpp>

#include "dynamic_model.hpp"

namespace rths::diagnosis {

/// A place inside a foreign simulation where a force may act.
struct ForeignPort {
  std::string component;               ///< "port.ball"
  std::string displacement, velocity;  ///< computed channels
  std::string displacement_unit, velocity_unit;
  std::optional<std::string> like;  ///< input with the size of its force; none: of its motion
};

/// A foreign simulation as [model] describes it.
struct ForeignReading {
  std::vector<std::string> inputs, outputs;  ///< roles
  std::vector<std::string> units;            ///< of outputs, SI; empty: not known
  std::vector<ModelParameter> parameters;
  std::vector<ForeignPort> ports;
  std::unique_ptr<foreign::Simulation> simulation;
  std::size_t most_runs = 0;
  Config rest;  ///< what is not read here
};

/// @throws Error file:line:column if the table describes no such simulation   @setup
[[nodiscard]] ForeignReading read_foreign_table(const Model& model);

}  // namespace rths::diagnosis

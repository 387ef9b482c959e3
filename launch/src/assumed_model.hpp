// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/core/config.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::launch {

/// What the simulation takes the laboratory for.
struct AssumedModel {
  sim::Bearing bearing;  ///< in the specimen's place
  std::string text;      ///< [model] of a case: bearing, machine and what was fitted, as TOML
};

/// Reads [model]: its tables `specimen` and `machine` say where the simulation takes specimen and
/// machine for something else than they are, `fitted` which of its parameters were fitted; the
/// files of `improvement` have tables of the same names, which are laid over these.
/// @param specimen  the bearing with what [specimen] changes of it
/// @param machine  [machine]
/// @param axial_load  on the bearing [N]
/// @throws Error with the place of the first wrong key or value   @setup
[[nodiscard]] AssumedModel read_assumed_model(const Config& model, const Config& specimen,
                                              const Config& machine, double axial_load);

}  // namespace rths::launch

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>

#include <rths/fmi/exchange.hpp>
#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// A variable of an FMU as a signal of the adapter.
struct Binding {
  const Variable* variable = nullptr;
  std::string signal;           ///< name
  std::uint32_t direction = 0;  ///< of rths_adapter.h
  bool is_ramped = false;
  std::string unit = "1";  ///< SI
  Conversion conversion;
};

struct Bindings {
  std::vector<Binding> signals;  ///< dimensionless inputs first, dimensionless outputs last
  std::vector<std::pair<const Variable*, double>> start;  ///< in the unit of the variable
};

/// Reads `signals`, `units`, `start`, `tunable` and `ramp` of a node.
///
/// Inputs need a signal or a start value. An output without a signal is a monitor, if its name can
/// be that of a signal. Without `is_complete`, the other signals are still to come from the map.
/// @param description  must outlive the result
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] Bindings read_bindings(const ModelDescription& description, const Config& table,
                                     bool is_complete);

/// A table whose `signals` also bind the inputs and outputs with the name of a signal.
[[nodiscard]] Config with_names(const ModelDescription& description, const Config& table,
                                const std::function<bool(const std::string&)>& is_signal);

}  // namespace rths::fmi

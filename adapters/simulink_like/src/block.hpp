// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <rths/adapters/simulink_like.hpp>
#include <rths/core/config.hpp>

#include "control_blocks.hpp"
#include "signal_blocks.hpp"

namespace rths::adapters {

/// An input or output of a block.
struct PortSpec {
  std::string name;
  bool per_axis = true;  ///< one value per axis, else a single value
  /// SI; empty: of an output, that of the first input; still empty after that: unknown. g++ needs
  /// the initializer, clang-tidy rejects it.
  std::string unit = {};  // NOLINT(readability-redundant-member-init)
  bool optional = false;  ///< an input that may stay unwired and then reads zeros
};

/// A parameter of a block that can be tuned while it runs.
struct ParameterSpec {
  std::string name;  ///< the key in the file, with unit: "velocity_gain_s"
  std::string unit = "1";
  double value = 0;
  std::optional<std::pair<double, double>> range = {};  // NOLINT: lowest and highest [unit]
};

/// All block types. Ring inputs and outputs do nothing in `step`: the diagram copies their values.
using BlockKind =
    std::variant<RingInput, RingOutput, Constant, ClockBlock, SineBlock, GainBlock, SumBlock,
                 SaturationBlock, RateLimiter, Switch, UnitDelay, TransportDelay, Derivative,
                 LowPassBlock, MovingAverageBlock, RemoveOffset, PredictorCorrectorBlock, AtsBlock,
                 AdaptiveInverseBlock, FeedForwardBlock, ForceObserverBlock,
                 TableForceObserverBlock, TargetForceBlock, VerticalForceBlock, LagCorrectionBlock,
                 Stop>;

struct Block {
  std::string name;
  std::string where;             ///< place in the file
  bool fast = false;             ///< runs at substeps times the base rate
  bool has_equal_units = false;  ///< all inputs and the output have one unit
  std::vector<PortSpec> inputs, outputs;
  std::vector<ParameterSpec> parameters;
  std::vector<std::string> wires;  ///< output that feeds each input, "block.port"; empty if unwired
  BlockKind kind;
};

/// Properties of the run and the block that its constructor needs.
struct BlockContext {
  const DiagramContext& run;
  double period;  ///< of this block [s]

  [[nodiscard]] std::size_t axes() const { return run.axes.size(); }
};

/// Builds a block from its table. @throws Error file:line:column
[[nodiscard]] Block make_block(const Config& table, const DiagramContext& run, double base_period,
                               int substeps);

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
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
  bool per_axis = true;  ///< one value per axis, else one
  /// SI; empty: as the first input's. g++ wants the initializer, clang-tidy does not.
  std::string unit = {};  // NOLINT(readability-redundant-member-init)
  bool optional = false;  ///< an input that may be left unwired; it then reads zeros
};

/// A setting of a block that may be tuned while it runs.
struct ParameterSpec {
  std::string name;  ///< as in the file, unit included: "velocity_gain_s"
  std::string unit = "1";
  double value = 0;
};

/// Everything a block can be. Ring inputs and outputs have no step: the target copies for them.
using BlockKind =
    std::variant<RingInput, RingOutput, Constant, ClockBlock, Sine, Gain, Sum, Saturation,
                 RateLimiter, Switch, UnitDelay, TransportDelay, Derivative, LowPassBlock,
                 MovingAverageBlock, RemoveOffset, PredictorCorrectorBlock, AtsBlock,
                 FeedForwardBlock, ForceObserverBlock, Stop>;

struct Block {
  std::string name;
  std::string where;  ///< place in the file
  bool fast = false;  ///< runs at substeps times the base rate
  std::vector<PortSpec> inputs, outputs;
  std::vector<ParameterSpec> parameters;
  std::vector<std::string> wires;  ///< source of each input, "block.port"; empty if unwired
  BlockKind kind;
};

/// What a block type needs in order to be built.
struct BlockContext {
  const DiagramContext& run;
  double period;  ///< of this block [s]

  [[nodiscard]] std::size_t axes() const { return run.axes.size(); }
};

/// Builds a block from its table. @throws Error file:line:column
[[nodiscard]] Block make_block(const Config& table, const DiagramContext& run, double base_period,
                               int substeps);

}  // namespace rths::adapters

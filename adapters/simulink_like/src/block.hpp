// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <rths/adapters/simulink_like.hpp>
#include <rths/controller/filters.hpp>
#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/maths/low_pass.hpp>

#include "control_blocks.hpp"

namespace rths::adapters {

// General signal blocks. Each treats all axes alike.

/// Reads values from the ring.
struct RingInput {
  std::vector<std::string> signals;
  void step(const Wires&) RTHS_REALTIME {}
};

/// Behaviour of a ring output when the run stops.
enum class AtStop { Ramp, Hold };

/// Writes values to the ring.
struct RingOutput {
  std::vector<std::string> signals;
  AtStop at_stop = AtStop::Hold;
  void step(const Wires&) RTHS_REALTIME {}
};

/// out = value
struct Constant {
  void step(const Wires& w) RTHS_REALTIME { *w.out[kOnly] = *w.parameter[kOnly]; }
};

/// out = amplitude · sin(2π frequency t)
struct SineBlock {
  struct Parameter {
    enum : std::size_t { kAmplitude, kFrequency };
  };
  void step(const Wires& w) RTHS_REALTIME {
    const double value =
        *w.parameter[Parameter::kAmplitude] *
        std::sin(2 * std::numbers::pi * *w.parameter[Parameter::kFrequency] * w.time);
    std::fill_n(w.out[kOnly], w.axes, value);
  }
};

/// out = time of the step
struct ClockBlock {
  void step(const Wires& w) RTHS_REALTIME { *w.out[kOnly] = w.time; }
};

/// out = gain · in
struct GainBlock {
  bool is_single = false;  ///< single values, else one per axis
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < (is_single ? 1 : w.axes); ++i)
      w.out[kOnly][i] = *w.parameter[kOnly] * w.in[kOnly][i];
  }
};

/// out = ± in1 ± in2 …, with the given signs
struct SumBlock {
  std::vector<double> signs;
  bool is_single = false;  ///< single values, else one per axis
  void step(const Wires& w) RTHS_REALTIME {
    const std::size_t count = is_single ? 1 : w.axes;
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < signs.size(); ++k) sum += signs[k] * w.in[k][i];
      w.out[kOnly][i] = sum;
    }
  }
};

/// Clamps a value to ± the limit of its axis.
struct SaturationBlock {
  std::vector<double> limits;
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < w.axes; ++i)
      w.out[kOnly][i] = std::clamp(w.in[kOnly][i], -limits[i], limits[i]);
  }
};

/// Limits the change of a value to limit·period per step; holds it while the input is not finite.
struct RateLimiter {
  std::vector<double> limits;  ///< [unit/s]
  double period;
  std::vector<double> last;
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < w.axes; ++i) {
      const double change = limits[i] * period;
      if (std::isfinite(w.in[kOnly][i]))
        last[i] = std::clamp(w.in[kOnly][i], last[i] - change, last[i] + change);
      w.out[kOnly][i] = last[i];
    }
  }
};

/// out = in1 while the parameter is not 0, else in2
struct Switch {
  struct In {
    enum : std::size_t { kFirst, kSecond };
  };
  void step(const Wires& w) RTHS_REALTIME {
    std::copy_n(*w.parameter[kOnly] != 0 ? w.in[In::kFirst] : w.in[In::kSecond], w.axes,
                w.out[kOnly]);
  }
};

/// out = in of the previous step. Breaks algebraic loops: it outputs before it reads its input.
struct UnitDelay {
  std::vector<double> held;
  void step(const Wires& w) RTHS_REALTIME { std::copy(held.begin(), held.end(), w.out[kOnly]); }
  void update(const Wires& w) RTHS_REALTIME { std::copy_n(w.in[kOnly], held.size(), held.begin()); }
};

/// out = in, delayed by a whole number of steps
struct TransportDelay {
  std::vector<double> line;  ///< steps × axes
  std::size_t head = 0;
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < w.axes; ++i) {
      double& stored = line[head * w.axes + i];
      w.out[kOnly][i] = stored;
      stored = w.in[kOnly][i];
    }
    head = (head + 1) % (line.size() / w.axes);
  }
};

/// Backward difference over one step.
struct Derivative {
  double period;
  std::vector<double> last;
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < w.axes; ++i) {
      w.out[kOnly][i] = (w.in[kOnly][i] - last[i]) / period;
      last[i] = w.in[kOnly][i];
    }
  }
};

/// A filter per axis.
template <class Filter>
struct FilterBlock {
  std::vector<Filter> filters;
  void step(const Wires& w) RTHS_REALTIME {
    for (std::size_t i = 0; i < w.axes; ++i) w.out[kOnly][i] = filters[i](w.in[kOnly][i]);
  }
};
using LowPassBlock = FilterBlock<maths::LowPass>;
using MovingAverageBlock = FilterBlock<controller::MovingAverage>;

/// Subtracts the mean of the first samples; outputs 0 until it is known.
struct RemoveOffset {
  long samples;
  long seen = 0;
  std::vector<double> sum;
  void step(const Wires& w) RTHS_REALTIME {
    const bool learning = seen < samples;
    seen += learning ? 1 : 0;
    for (std::size_t i = 0; i < w.axes; ++i) {
      if (learning) sum[i] += w.in[kOnly][i];
      w.out[kOnly][i] = learning ? 0 : w.in[kOnly][i] - sum[i] / static_cast<double>(samples);
    }
  }
};

/// Ends the run when its input is above 0.
struct Stop {
  bool requested = false;
  void step(const Wires& w) RTHS_REALTIME { requested = requested || *w.in[kOnly] > 0; }
};

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

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>

#include "block.hpp"

namespace rths::adapters {

/// A block diagram, wired and in order: base-rate blocks that feed the fast ones, then the fast
/// ones `substeps` times, then base-rate blocks behind them.
class Diagram {
 public:
  /// @throws Error file:line:column   @setup
  Diagram(const Config& file, const DiagramContext& context);
  Diagram(const Diagram&) = delete;
  Diagram& operator=(const Diagram&) = delete;

  /// What the diagram exchanges: ring inputs, parameters, ring outputs, monitors, in this order.
  [[nodiscard]] std::vector<Port> ports() const;
  [[nodiscard]] double period() const { return period_; }  ///< [s]

  /// One base period. Copies inputs and parameters in, runs the blocks, copies monitors and ring
  /// outputs out.   @realtime
  void step(double time, std::span<const double> inputs, std::span<double> outputs) RTHS_REALTIME;
  /// True once a stop block has been asked to stop.   @realtime
  [[nodiscard]] bool stop_requested() const RTHS_REALTIME;
  /// Positions among the outputs of the values that ramp when the run stops.
  [[nodiscard]] const std::vector<std::size_t>& ramped_outputs() const { return ramped_outputs_; }

 private:
  /// Where a block's values are.
  struct Placed {
    Block block;
    std::vector<std::size_t> out_at;        ///< of each output in `values_`
    std::vector<std::size_t> parameter_at;  ///< of each parameter in `values_`
    Wires wires;
  };
  struct Source {
    std::size_t block, output;
  };
  /// A copy between the adapter's arrays and `values_`.
  struct Copy {
    std::size_t outside, inside;
  };

  void place();
  void wire();
  void connect_input(Placed& placed, std::size_t input);
  void check_fit(const Placed& placed, const PortSpec& input, const PortSpec& source,
                 const std::string& wire) const;
  [[nodiscard]] Source find_source(const Placed& placed, const std::string& wire) const;
  [[nodiscard]] std::size_t width(const PortSpec& port) const;
  void order();
  void visit(std::size_t block, std::vector<int>& marks, std::vector<std::size_t>& sorted,
             std::vector<std::size_t>& path) const;
  [[nodiscard]] bool is_behind_fast(std::size_t block, const std::vector<bool>& behind_fast) const;
  void split_by_rate(const std::vector<std::size_t>& sorted);
  void bind_ports();
  void bind_ring_input(const Placed& placed);
  void bind_parameters(const Placed& placed);
  void bind_ring_output(const Placed& placed);
  void bind_monitors(const Placed& placed);
  void run(const std::vector<std::size_t>& blocks, double time) noexcept;

  DiagramContext context_;
  double period_;
  int substeps_;
  std::vector<Placed> blocks_;
  std::vector<std::vector<std::size_t>>
      feeds_;  ///< blocks that a block reads from in the same step
  std::vector<double> values_;
  std::vector<std::size_t> before_, fast_, after_;
  std::vector<std::size_t> base_delays_, fast_delays_;
  std::vector<Copy> copies_in_, copies_out_;
  std::vector<std::size_t> ramped_outputs_;
  std::vector<std::size_t> stops_;
  std::vector<Port> ports_;
};

}  // namespace rths::adapters

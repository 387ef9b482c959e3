// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>

#include "block.hpp"

namespace rths::adapters {

/// A wired and sorted block diagram. A step runs the base-rate blocks that feed the fast section,
/// the fast section `substeps` times, then the base-rate blocks downstream of it.
class Diagram {
 public:
  /// @throws Error file:line:column   @setup
  Diagram(const Config& file, const DiagramContext& context);
  Diagram(const Diagram&) = delete;
  Diagram& operator=(const Diagram&) = delete;

  /// Returns ring inputs, parameters, ring outputs and monitors, in this order.
  [[nodiscard]] std::vector<Port> ports() const;
  [[nodiscard]] double period() const { return period_; }  ///< [s]

  /// Runs one base period: copies inputs and parameters in, runs the blocks, copies monitors and
  /// ring outputs out.
  /// @param is_missed  made after its time: a command waits   @realtime
  void step(double time, bool is_missed, std::span<const double> inputs,
            std::span<double> outputs) RTHS_REALTIME;
  /// Whether a stop block was triggered.   @realtime
  [[nodiscard]] bool stop_requested() const RTHS_REALTIME;
  /// Indices of the outputs that ramp when the run stops.
  [[nodiscard]] const std::vector<std::size_t>& ramped_outputs() const { return ramped_outputs_; }

 private:
  /// A block and the locations of its values.
  struct WiredBlock {
    Block block;
    std::vector<std::size_t> out_at;        ///< index of each output in `values_`
    std::vector<std::size_t> parameter_at;  ///< index of each parameter in `values_`
    Wires wires;
  };
  /// Indices of a block and of one of its outputs.
  struct OutputId {
    std::size_t block, output;
  };
  /// A copy between the adapter's arrays and `values_`.
  struct Copy {
    std::size_t outside, inside;
  };

  void allocate_values();
  // Units of the ring's signals, then of the outputs that follow their inputs.
  void take_units_of_map();
  void take_unit_of_map(Block& block, PortSpec& port,
                        const std::vector<std::string>& signals) const;
  void resolve_units();
  [[nodiscard]] std::string unit_of_inputs(const WiredBlock& wired) const;
  void wire();
  void connect_input(WiredBlock& wired, std::size_t input);
  void check_fit(const WiredBlock& wired, const PortSpec& input, const PortSpec& output,
                 const std::string& wire) const;
  void check_derivative(const WiredBlock& wired) const;
  [[nodiscard]] OutputId find_output(const WiredBlock& wired, const std::string& wire) const;
  [[nodiscard]] std::size_t width(const PortSpec& port) const;
  void order();
  void visit(std::size_t block, std::vector<int>& marks, std::vector<std::size_t>& sorted,
             std::vector<std::size_t>& path) const;
  [[nodiscard]] bool is_downstream_of_fast(std::size_t block,
                                           const std::vector<bool>& downstream) const;
  void split_by_rate(const std::vector<std::size_t>& sorted);
  void bind_ports();
  void bind_ring_input(const WiredBlock& wired);
  void bind_parameters(const WiredBlock& wired);
  void bind_ring_output(const WiredBlock& wired);
  void bind_monitors(const WiredBlock& wired);
  void run(const std::vector<std::size_t>& blocks, double time, bool is_missed) noexcept;

  DiagramContext context_;
  double period_;
  int substeps_;
  std::vector<WiredBlock> blocks_;
  std::vector<std::vector<std::size_t>> feeds_;  ///< blocks that feed a block in the same step
  std::vector<double> values_;
  std::vector<std::size_t> before_, fast_, after_;
  std::vector<std::size_t> base_delays_, fast_delays_;
  std::vector<Copy> copies_in_, copies_out_;
  std::vector<std::size_t> ramped_outputs_;
  std::vector<std::size_t> stops_;
  std::vector<Port> ports_;
};

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include "diagram.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/experiment/node.hpp>
#include <rths/memmap/units.hpp>

namespace rths::adapters {
namespace {

constexpr int kMostSubsteps = 100;

std::vector<std::string> output_names(const Block& block) {
  std::vector<std::string> names;
  for (const auto& output : block.outputs) names.push_back(block.name + "." + output.name);
  return names;
}

// Spellings of one quantity: "N" and "kN" carry the same SI values.
bool are_equal_units(const std::string& a, const std::string& b) {
  return a == b || memmap::parse_unit(a).si == memmap::parse_unit(b).si;
}

// A port of the adapter has a unit; an unknown one is a pure number.
std::string or_number(const std::string& unit) { return unit.empty() ? "1" : unit; }

bool is_unit_delay(const Block& block) { return std::holds_alternative<UnitDelay>(block.kind); }

}  // namespace

Diagram::Diagram(const Config& file, const DiagramContext& context) : context_{context} {
  const std::int64_t format = file.integer("diagram");
  if (format != kDiagramFormat)
    file.fail("diagram",
              fmt::format("diagram is {}, this program reads {}", format, kDiagramFormat));
  static_cast<void>(file.text("name", ""));
  period_ = 1 / file.number_in("base_rate_Hz", 1, 100'000);
  substeps_ = static_cast<int>(file.integer_in("substeps", 1, kMostSubsteps, 1));
  std::set<std::string> names;
  for (const auto& table : experiment::blocks_of(file, context_.constants, context_.blocks)) {
    blocks_.push_back({make_block(table, context_, period_, substeps_), {}, {}, {}});
    if (!names.insert(blocks_.back().block.name).second)
      table.fail("name", fmt::format("there are two blocks '{}'", blocks_.back().block.name));
  }
  file.reject_unknown_keys();
  if (blocks_.empty()) throw Error{file.where() + ": the diagram has no blocks"};
  allocate_values();
  take_units_of_map();
  resolve_units();
  wire();
  order();
  bind_ports();
}

std::size_t Diagram::width(const PortSpec& port) const {
  return port.per_axis ? context_.axes.size() : 1;
}

// All values of the diagram are in one array; it ends with zeros for unwired inputs.
void Diagram::allocate_values() {
  std::size_t next = 0;
  for (auto& wired : blocks_) {
    for (const auto& output : wired.block.outputs) {
      wired.out_at.push_back(next);
      next += width(output);
    }
    for (const auto& parameter : wired.block.parameters) {
      static_cast<void>(parameter);
      wired.parameter_at.push_back(next++);
    }
  }
  values_.assign(next + context_.axes.size(), 0.0);
  for (auto& wired : blocks_) {
    wired.wires.axes = context_.axes.size();
    for (const auto at : wired.out_at) wired.wires.out.push_back(&values_[at]);
    for (std::size_t i = 0; i < wired.parameter_at.size(); ++i) {
      values_[wired.parameter_at[i]] = wired.block.parameters[i].value;
      wired.wires.parameter.push_back(&values_[wired.parameter_at[i]]);
    }
  }
}

Diagram::OutputId Diagram::find_output(const WiredBlock& wired, const std::string& wire) const {
  std::vector<std::string> known;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto names = output_names(blocks_[b].block);
    for (std::size_t o = 0; o < names.size(); ++o)
      if (names[o] == wire || (names.size() == 1 && blocks_[b].block.name == wire)) return {b, o};
    known.insert(known.end(), names.begin(), names.end());
  }
  throw Error{fmt::format("{}: block '{}' reads '{}', which no block outputs{}", wired.block.where,
                          wired.block.name, wire, did_you_mean(wire, known))};
}

void Diagram::check_fit(const WiredBlock& wired, const PortSpec& input, const PortSpec& output,
                        const std::string& wire) const {
  if (width(input) != width(output))
    throw Error{fmt::format("{}: '{}.{}' takes {}, '{}' gives {}", wired.block.where,
                            wired.block.name, input.name,
                            input.per_axis ? "one value per axis" : "a single value", wire,
                            output.per_axis ? "one per axis" : "a single one")};
  if (input.unit.empty() || output.unit.empty() || are_equal_units(input.unit, output.unit)) return;
  const auto* ring = std::get_if<RingOutput>(&wired.block.kind);
  throw Error{fmt::format(
      "{}: '{}.{}' takes [{}]{}, '{}' gives [{}]", wired.block.where, wired.block.name, input.name,
      input.unit, ring == nullptr ? "" : fmt::format(", the unit of '{}'", ring->signals[0]), wire,
      output.unit)};
}

void Diagram::check_derivative(const WiredBlock& wired) const {
  if (!std::holds_alternative<Derivative>(wired.block.kind)) return;
  const std::string input = unit_of_inputs(wired), &stated = wired.block.outputs[0].unit;
  if (input.empty()) return;
  const std::string expected = memmap::parse_unit(fmt::format("({}).s-1", input)).si;
  if (!are_equal_units(expected, stated))
    throw Error{fmt::format("{}: '{}' has unit [{}], the derivative of [{}] has [{}]",
                            wired.block.where, wired.block.name, stated, input, expected)};
}

void Diagram::connect_input(WiredBlock& wired, std::size_t input) {
  const std::string& wire = wired.block.wires[input];
  const auto self = static_cast<std::size_t>(&wired - blocks_.data());
  if (wire.empty()) {
    wired.wires.in.push_back(&values_[values_.size() - context_.axes.size()]);
    return;
  }
  const OutputId feed = find_output(wired, wire);
  const WiredBlock& from = blocks_[feed.block];
  check_fit(wired, wired.block.inputs[input], from.block.outputs[feed.output], wire);
  wired.wires.in.push_back(&values_[from.out_at[feed.output]]);
  if (!is_unit_delay(wired.block)) feeds_[self].push_back(feed.block);
}

// A signal of a run's own partitions (monitor.…, tune.…) is not in the laboratory's map.
void Diagram::take_unit_of_map(Block& block, PortSpec& port,
                               const std::vector<std::string>& signals) const {
  for (const auto& signal : signals) {
    if (signal.starts_with("monitor.") || signal.starts_with("tune.")) continue;
    const auto known = context_.signal_units.find(signal);
    if (known == context_.signal_units.end()) {
      std::vector<std::string> names;
      for (const auto& [name, unit] : context_.signal_units) names.push_back(name);
      throw Error{fmt::format("{}: block '{}': the map has no signal '{}'{}", block.where,
                              block.name, signal, did_you_mean(signal, names))};
    }
    if (port.unit.empty()) port.unit = memmap::parse_unit(known->second).si;
    if (!are_equal_units(port.unit, known->second))
      throw Error{fmt::format("{}: block '{}' has unit [{}], the map gives '{}' [{}]", block.where,
                              block.name, port.unit, signal, memmap::parse_unit(known->second).si)};
  }
}

void Diagram::take_units_of_map() {
  if (context_.signal_units.empty()) return;
  for (auto& wired : blocks_) {
    Block& block = wired.block;
    if (const auto* input = std::get_if<RingInput>(&block.kind))
      take_unit_of_map(block, block.outputs[0], input->signals);
    if (const auto* output = std::get_if<RingOutput>(&block.kind))
      take_unit_of_map(block, block.inputs[0], output->signals);
  }
}

// Unit of the first input, or of any input if all have one unit; empty: unknown.
std::string Diagram::unit_of_inputs(const WiredBlock& wired) const {
  const auto& wires = wired.block.wires;
  for (std::size_t i = 0; i < (wired.block.has_equal_units ? wires.size() : 1); ++i) {
    if (i >= wires.size() || wires[i].empty()) continue;
    const OutputId feed = find_output(wired, wires[i]);
    const std::string& unit = blocks_[feed.block].block.outputs[feed.output].unit;
    if (!unit.empty()) return unit;
  }
  return "";
}

void Diagram::resolve_units() {
  // An input's unit may itself come from an input, which may need several passes.
  for (std::size_t pass = 0; pass < blocks_.size(); ++pass)
    for (auto& wired : blocks_)
      for (auto& output : wired.block.outputs)
        if (output.unit.empty()) output.unit = unit_of_inputs(wired);
  for (auto& wired : blocks_) {
    if (wired.block.has_equal_units)
      for (auto& input : wired.block.inputs) input.unit = wired.block.outputs[0].unit;
    check_derivative(wired);
  }
}

void Diagram::wire() {
  feeds_.resize(blocks_.size());
  for (auto& wired : blocks_)
    for (std::size_t input = 0; input < wired.block.inputs.size(); ++input)
      connect_input(wired, input);
}

void Diagram::visit(std::size_t block, std::vector<int>& marks, std::vector<std::size_t>& sorted,
                    std::vector<std::size_t>& path) const {
  constexpr int kOpen = 1;
  constexpr int kSorted = 2;
  if (marks[block] == kSorted) return;
  path.push_back(block);
  if (marks[block] == kOpen) {
    std::string loop;
    for (auto at = std::find(path.begin(), path.end(), block); at != path.end(); ++at)
      loop += (loop.empty() ? "" : " <- ") + blocks_[*at].block.name;
    throw Error{fmt::format("{}: algebraic loop: {}; a unit_delay block would break it",
                            blocks_[block].block.where, loop)};
  }
  marks[block] = kOpen;
  for (const auto feeder : feeds_[block]) visit(feeder, marks, sorted, path);
  marks[block] = kSorted;
  sorted.push_back(block);
  path.pop_back();
}

void Diagram::order() {
  std::vector<int> marks(blocks_.size(), 0);
  std::vector<std::size_t> sorted;
  std::vector<std::size_t> path;
  for (std::size_t i = 0; i < blocks_.size(); ++i) visit(i, marks, sorted, path);
  split_by_rate(sorted);
}

// A block is downstream of the fast section if one of its inputs comes from there. The fast section
// runs as a unit, so no base-rate block may lie between two fast blocks.
bool Diagram::is_downstream_of_fast(std::size_t block, const std::vector<bool>& downstream) const {
  bool is_downstream = false;
  for (const auto feeder : feeds_[block]) {
    const Block& from = blocks_[feeder].block;
    if (blocks_[block].block.fast && !from.fast && downstream[feeder])
      throw Error{fmt::format("{}: block '{}' at the base rate lies between fast blocks",
                              from.where, from.name)};
    is_downstream = is_downstream || from.fast || downstream[feeder];
  }
  return is_downstream;
}

void Diagram::split_by_rate(const std::vector<std::size_t>& sorted) {
  std::vector<bool> downstream(blocks_.size(), false);
  for (const auto i : sorted) {
    const Block& block = blocks_[i].block;
    downstream[i] = is_downstream_of_fast(i, downstream);
    (block.fast ? fast_ : downstream[i] ? after_ : before_).push_back(i);
    if (is_unit_delay(block)) (block.fast ? fast_delays_ : base_delays_).push_back(i);
    if (std::holds_alternative<Stop>(block.kind)) stops_.push_back(i);
  }
}

void Diagram::bind_ports() {
  for (const auto& wired : blocks_) bind_ring_input(wired);
  for (const auto& wired : blocks_) bind_parameters(wired);
  for (const auto& wired : blocks_) bind_ring_output(wired);
  for (const auto& wired : blocks_) bind_monitors(wired);
}

void Diagram::bind_ring_input(const WiredBlock& wired) {
  const auto* ring = std::get_if<RingInput>(&wired.block.kind);
  if (ring == nullptr) return;
  for (std::size_t i = 0; i < ring->signals.size(); ++i) {
    ports_.push_back(
        {ring->signals[i], Direction::Input, or_number(wired.block.outputs[0].unit), 0, false});
    copies_in_.push_back({copies_in_.size(), wired.out_at[0] + i});
  }
}

void Diagram::bind_parameters(const WiredBlock& wired) {
  for (std::size_t i = 0; i < wired.block.parameters.size(); ++i) {
    const auto& parameter = wired.block.parameters[i];
    ports_.push_back({wired.block.name + "." + parameter.name, Direction::Parameter,
                      or_number(parameter.unit), parameter.value, false, parameter.range});
    copies_in_.push_back({copies_in_.size(), wired.parameter_at[i]});
  }
}

void Diagram::bind_ring_output(const WiredBlock& wired) {
  const auto* ring = std::get_if<RingOutput>(&wired.block.kind);
  if (ring == nullptr) return;
  const OutputId feed = find_output(wired, wired.block.wires[0]);
  const WiredBlock& from = blocks_[feed.block];
  for (std::size_t i = 0; i < ring->signals.size(); ++i) {
    const std::string& unit = wired.block.inputs[0].unit;
    ports_.push_back({ring->signals[i], Direction::Output,
                      or_number(unit.empty() ? from.block.outputs[feed.output].unit : unit), 0,
                      false});
    if (ring->at_stop == AtStop::Ramp) ramped_outputs_.push_back(copies_out_.size());
    copies_out_.push_back({copies_out_.size(), from.out_at[feed.output] + i});
  }
}

void Diagram::bind_monitors(const WiredBlock& wired) {
  for (std::size_t o = 0; o < wired.block.outputs.size(); ++o) {
    const PortSpec& output = wired.block.outputs[o];
    for (std::size_t i = 0; i < width(output); ++i) {
      const std::string axis = output.per_axis ? "." + context_.axes[i] : "";
      ports_.push_back({wired.block.name + "." + output.name + axis, Direction::Monitor,
                        or_number(output.unit), 0, false});
      copies_out_.push_back({copies_out_.size(), wired.out_at[o] + i});
    }
  }
}

std::vector<Port> Diagram::ports() const { return ports_; }

void Diagram::run(const std::vector<std::size_t>& blocks, double time, bool is_missed) noexcept {
  for (const auto i : blocks) {
    WiredBlock& wired = blocks_[i];
    wired.wires.time = time;
    wired.wires.is_missed = is_missed;
    std::visit([&](auto& kind) { kind.step(wired.wires); }, wired.block.kind);
  }
}

void Diagram::step(double time, bool is_missed, std::span<const double> inputs,
                   std::span<double> outputs) noexcept {
  const auto update = [&](const std::vector<std::size_t>& delays) {
    for (const auto i : delays) std::get<UnitDelay>(blocks_[i].block.kind).update(blocks_[i].wires);
  };
  for (const auto& copy : copies_in_) values_[copy.inside] = inputs[copy.outside];
  run(before_, time, is_missed);
  for (int substep = 0; substep < substeps_; ++substep) {
    run(fast_, time + substep * period_ / substeps_, is_missed);
    update(fast_delays_);
  }
  run(after_, time, is_missed);
  update(base_delays_);
  for (const auto& copy : copies_out_) outputs[copy.outside] = values_[copy.inside];
}

bool Diagram::stop_requested() const noexcept {
  for (const auto i : stops_)
    if (std::get<Stop>(blocks_[i].block.kind).requested) return true;
  return false;
}

}  // namespace rths::adapters

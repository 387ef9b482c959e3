// SPDX-License-Identifier: Apache-2.0
//
// Builds signal blocks from [[block]] tables: one function per type; the table of all types is at
// the end.
#include <cmath>

#include <fmt/format.h>

#include <rths/experiment/block_settings.hpp>
#include <rths/maths/low_pass.hpp>
#include <rths/memmap/units.hpp>

#include "block_tables.hpp"

namespace rths::adapters {
namespace {

// The signals of a ring port: "{axis}" in the name expands to one signal per axis.
std::vector<std::string> expand_axes(const std::string& pattern, const BlockContext& context) {
  const auto position = pattern.find("{axis}");
  if (position == std::string::npos) return {pattern};
  std::vector<std::string> signals;
  for (const auto& axis : context.run.axes)
    signals.push_back(std::string{pattern}.replace(position, std::string{"{axis}"}.size(), axis));
  return signals;
}

bool names_axes(const std::string& pattern) { return pattern.find("{axis}") != std::string::npos; }

std::vector<double> limits(const Config& table, const BlockContext& context) {
  if (!table.has("limits")) table.fail("limits", "'limits' is missing: one per axis, long first");
  const auto values = experiment::per_axis(table, "limits", context.run.axes, 0);
  for (const double value : values)
    if (!(value > 0))
      table.fail("limits", fmt::format("a limit is {:g}, expected a positive number", value));
  return values;
}

// The unit that a block states; empty: none.
std::string stated_unit(const Config& table) {
  const std::string unit = table.text("unit", "");
  if (!unit.empty())
    static_cast<void>(table.placed("unit", [&] { return memmap::parse_unit(unit); }));
  return unit;
}

Block make_ring_input(const Config& table, const BlockContext& context) {
  Block block;
  const std::string pattern = table.text("signal");
  block.kind = RingInput{expand_axes(pattern, context)};
  block.outputs = {{"out", names_axes(pattern), stated_unit(table)}};
  return block;
}

Block make_ring_output(const Config& table, const BlockContext& context) {
  Block block;
  const std::string pattern = table.text("signal");
  const std::string at_stop = table.text("at_stop", "hold");
  if (at_stop != "hold" && at_stop != "ramp")
    table.fail("at_stop", fmt::format("at_stop is '{}', expected hold or ramp", at_stop));
  block.kind =
      RingOutput{expand_axes(pattern, context), at_stop == "ramp" ? AtStop::Ramp : AtStop::Hold};
  block.inputs = {{"in", names_axes(pattern)}};
  return block;
}

Block make_constant(const Config& table, const BlockContext&) {
  Block block;
  const std::string unit = stated_unit(table);
  add_parameter(block, table, "value", unit, 0);
  block.outputs = {{"out", kSingle, unit}};
  block.kind = Constant{};
  return block;
}

Block make_static_load(const Config& table, const BlockContext& context) {
  const auto& specimen = context.run.specimen;
  Block block;
  add_parameter(block, table, "value", "N", specimen ? specimen->axial_load : 0);
  block.outputs = {{"out", kSingle, "N"}};
  block.kind = Constant{};
  return block;
}

Block make_clock(const Config&, const BlockContext&) {
  Block block;
  block.outputs = {{"out", kSingle, "s"}};
  block.kind = ClockBlock{};
  return block;
}

Block make_sine(const Config& table, const BlockContext&) {
  Block block;
  const std::string unit = stated_unit(table);
  add_parameter(block, table, "amplitude", unit, 1);
  add_parameter(block, table, "frequency_Hz", "Hz", 1);
  block.outputs = {{"out", kPerAxis, unit}};
  block.kind = SineBlock{};
  return block;
}

// A block with one per-axis input and one per-axis output of the same unit.
Block through(BlockKind kind) {
  Block block;
  block.inputs = {{"in"}};
  block.outputs = {{"out"}};
  block.kind = std::move(kind);
  return block;
}

Block make_gain(const Config& table, const BlockContext&) {
  const bool is_single = table.flag("single", false);
  Block block = through(GainBlock{is_single});
  block.inputs[0].per_axis = block.outputs[0].per_axis = !is_single;
  block.outputs[0].unit = stated_unit(table);
  add_parameter(block, table, "gain", "1", 1);
  return block;
}

Block make_sum(const Config& table, const BlockContext&) {
  const std::string text = table.text("signs", "++");
  SumBlock sum;
  sum.is_single = table.flag("single", false);
  Block block;
  for (const char sign : text) {
    if (sign != '+' && sign != '-')
      table.fail("signs", fmt::format("signs is '{}', expected '+' and '-' only", text));
    sum.signs.push_back(sign == '+' ? 1 : -1);
    block.inputs.push_back({fmt::format("in{}", sum.signs.size()), !sum.is_single});
  }
  block.outputs = {{"out", !sum.is_single}};
  block.has_equal_units = true;
  block.kind = std::move(sum);
  return block;
}

Block make_saturation(const Config& table, const BlockContext& context) {
  return through(SaturationBlock{limits(table, context)});
}

Block make_rate_limiter(const Config& table, const BlockContext& context) {
  return through(
      RateLimiter{limits(table, context), context.period, std::vector<double>(context.axes())});
}

Block make_switch(const Config& table, const BlockContext&) {
  Block block = through(Switch{});
  block.inputs = {{"in1"}, {"in2"}};
  block.has_equal_units = true;
  add_parameter(block, table, "first", "1", 1, kOffOrOn);
  return block;
}

Block make_unit_delay(const Config& table, const BlockContext& context) {
  const bool is_single = table.flag("single", false);
  Block block = through(UnitDelay{std::vector<double>(is_single ? 1 : context.axes())});
  block.inputs[0].per_axis = block.outputs[0].per_axis = !is_single;
  return block;
}

Block make_transport_delay(const Config& table, const BlockContext& context) {
  const double delay = table.number_in("delay_s", context.period, 10);
  const auto steps = static_cast<std::size_t>(std::lround(delay / context.period));
  return through(TransportDelay{std::vector<double>(steps * context.axes())});
}

Block make_derivative(const Config& table, const BlockContext& context) {
  Block block = through(Derivative{context.period, std::vector<double>(context.axes())});
  static_cast<void>(table.text("unit"));
  block.outputs[0].unit = stated_unit(table);
  return block;
}

Block make_low_pass(const Config& table, const BlockContext& context) {
  const int order = static_cast<int>(table.integer_in("order", 2, 8, 2));
  const double cutoff = table.number("cutoff_Hz");
  const auto filter = table.placed("cutoff_Hz", [&] {
    return maths::LowPass{order, cutoff, context.period};
  });
  return through(LowPassBlock{std::vector(context.axes(), filter)});
}

Block make_moving_average(const Config& table, const BlockContext& context) {
  const controller::MovingAverage filter{static_cast<int>(table.integer_in("samples", 1, 10'000))};
  return through(MovingAverageBlock{std::vector(context.axes(), filter)});
}

Block make_remove_offset(const Config& table, const BlockContext& context) {
  const double duration = table.number_in("duration_s", context.period, 100, 1.0);
  return through(
      RemoveOffset{std::lround(duration / context.period), 0, std::vector<double>(context.axes())});
}

Block make_stop(const Config&, const BlockContext&) {
  Block block;
  block.inputs = {{"in", kSingle}};
  block.kind = Stop{};
  return block;
}

struct BlockType {
  const char* name;
  Block (*make)(const Config&, const BlockContext&);
};
constexpr BlockType kBlockTypes[] = {{"ring_input", make_ring_input},
                                     {"ring_output", make_ring_output},
                                     {"constant", make_constant},
                                     {"static_load", make_static_load},
                                     {"clock", make_clock},
                                     {"sine", make_sine},
                                     {"gain", make_gain},
                                     {"sum", make_sum},
                                     {"saturation", make_saturation},
                                     {"rate_limiter", make_rate_limiter},
                                     {"switch", make_switch},
                                     {"unit_delay", make_unit_delay},
                                     {"transport_delay", make_transport_delay},
                                     {"derivative", make_derivative},
                                     {"low_pass", make_low_pass},
                                     {"moving_average", make_moving_average},
                                     {"remove_offset", make_remove_offset},
                                     {"predictor_corrector", make_predictor_corrector},
                                     {"ats", make_ats},
                                     {"adaptive_inverse", make_adaptive_inverse},
                                     {"feed_forward", make_feed_forward},
                                     {"force_observer", make_force_observer},
                                     {"table_force_observer", make_table_force_observer},
                                     {"target_force", make_target_force},
                                     {"vertical_force", make_vertical_force},
                                     {"lag_correction", make_lag_correction},
                                     {"stop", make_stop}};

const BlockType& type_named(const Config& table) {
  const std::string name = table.text("type");
  std::vector<std::string> known;
  for (const auto& type : kBlockTypes) {
    if (type.name == name) return type;
    known.emplace_back(type.name);
  }
  table.fail("type", fmt::format("there is no block type '{}'{}", name, did_you_mean(name, known)));
}

void read_wires(const Config& table, Block& block) {
  const Config wires = table.table_or_empty("in");
  for (const auto& input : block.inputs)
    block.wires.push_back(input.optional ? wires.text(input.name, "") : wires.text(input.name));
  wires.reject_unknown_keys();
}

// `range.<parameter> = [lowest, highest]` replaces the range of the type.
void read_ranges(const Config& table, Block& block) {
  const Config ranges = table.table_or_empty("range");
  for (auto& parameter : block.parameters) {
    if (ranges.has(parameter.name)) {
      const auto bounds = ranges.numbers(parameter.name);
      if (bounds.size() != 2 || !(bounds[0] < bounds[1]))
        ranges.fail(parameter.name, "a range is [lowest, highest]");
      parameter.range = {bounds[0], bounds[1]};
    }
    if (!parameter.range) continue;
    const auto [low, high] = *parameter.range;
    if (!(parameter.value >= low && parameter.value <= high))
      table.fail(parameter.name, fmt::format("{} is {}, expected {} to {}", parameter.name,
                                             parameter.value, low, high));
  }
  ranges.reject_unknown_keys();
}

}  // namespace

Block make_block(const Config& table, const DiagramContext& run, double base_period, int substeps) {
  const std::string name = table.text("name");
  std::int64_t rate = table.integer("rate", 1);
  if (rate != 1 && rate != substeps)
    table.fail("rate", fmt::format("rate is {}, expected 1 or {}", rate, substeps));
  // Between targets that come in every tick there is no command to compute.
  if (type_named(table).make == make_predictor_corrector &&
      experiment::is_one_tick(run.simulation_step, base_period))
    rate = 1;
  const BlockContext context{run, base_period / static_cast<double>(rate)};
  Block block = type_named(table).make(table, context);
  block.name = name;
  block.where = table.where();
  block.fast = rate != 1;
  read_wires(table, block);
  read_ranges(table, block);
  table.reject_unknown_keys();
  return block;
}

}  // namespace rths::adapters

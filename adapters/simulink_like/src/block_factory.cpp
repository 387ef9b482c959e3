// SPDX-License-Identifier: Apache-2.0
//
// From a [[block]] table to a block: one function per type, and the table of types at the end.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "block.hpp"

namespace rths::adapters {
namespace {

using memmap::Config;

constexpr bool kPerAxis = true;
constexpr bool kSingle = false;

// The signals of a ring port: "{axis}" in the name stands for one signal per axis.
std::vector<std::string> expand_axes(const std::string& pattern, const BlockContext& context) {
  const auto place = pattern.find("{axis}");
  if (place == std::string::npos) return {pattern};
  std::vector<std::string> signals;
  for (const auto& axis : context.run.axes)
    signals.push_back(std::string{pattern}.replace(place, std::string{"{axis}"}.size(), axis));
  return signals;
}

bool names_axes(const std::string& pattern) { return pattern.find("{axis}") != std::string::npos; }

// One value per axis, of which a run uses those of its axes: long, lat, …
constexpr const char* kAxisOrder[] = {"long", "lat", "vert", "roll", "pitch", "yaw"};

std::vector<double> per_axis(const Config& table, const std::string& key,
                             const BlockContext& context, double otherwise) {
  std::vector<double> values;
  const auto given = table.numbers(key, {});
  for (const auto& axis : context.run.axes) {
    const auto order = static_cast<std::size_t>(
        std::find(std::begin(kAxisOrder), std::end(kAxisOrder), axis) - std::begin(kAxisOrder));
    if (given.empty())
      values.push_back(otherwise);
    else if (order < given.size())
      values.push_back(given[order]);
    else
      table.fail(key,
                 fmt::format("{} has {} numbers, none for axis '{}'", key, given.size(), axis));
  }
  return values;
}

std::vector<double> limits(const Config& table, const BlockContext& context) {
  if (!table.has("limits")) table.fail("limits", "'limits' is missing: one per axis, long first");
  const auto values = per_axis(table, "limits", context, 0);
  for (const double value : values)
    if (!(value > 0)) table.fail("limits", "limits must be positive");
  return values;
}

void add_parameter(Block& block, const Config& table, const std::string& name,
                   const std::string& unit, double otherwise) {
  block.parameters.push_back({name, unit, table.number(name, otherwise)});
}

Block make_ring_input(const Config& table, const BlockContext& context) {
  Block block;
  const std::string pattern = table.text("signal");
  block.kind = RingInput{expand_axes(pattern, context)};
  block.outputs = {{"out", names_axes(pattern), table.text("unit", "1")}};
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
  const std::string unit = table.text("unit", "1");
  add_parameter(block, table, "value", unit, 0);
  block.outputs = {{"out", kSingle, unit}};
  block.kind = Constant{};
  return block;
}

Block make_sine(const Config& table, const BlockContext&) {
  Block block;
  const std::string unit = table.text("unit", "1");
  add_parameter(block, table, "amplitude", unit, 1);
  add_parameter(block, table, "frequency_Hz", "Hz", 1);
  block.outputs = {{"out", kPerAxis, unit}};
  block.kind = Sine{};
  return block;
}

// A block that turns one per-axis input into one per-axis output of the same unit.
Block through(BlockKind kind) {
  Block block;
  block.inputs = {{"in"}};
  block.outputs = {{"out"}};
  block.kind = std::move(kind);
  return block;
}

Block make_gain(const Config& table, const BlockContext&) {
  Block block = through(Gain{});
  block.outputs[0].unit = table.text("unit", "");
  add_parameter(block, table, "gain", "1", 1);
  return block;
}

Block make_sum(const Config& table, const BlockContext&) {
  const std::string text = table.text("signs", "++");
  Sum sum;
  Block block;
  for (const char sign : text) {
    if (sign != '+' && sign != '-')
      table.fail("signs", fmt::format("signs is '{}', expected '+' and '-' only", text));
    sum.signs.push_back(sign == '+' ? 1 : -1);
    block.inputs.push_back({fmt::format("in{}", sum.signs.size())});
  }
  block.outputs = {{"out"}};
  block.kind = std::move(sum);
  return block;
}

Block make_saturation(const Config& table, const BlockContext& context) {
  return through(Saturation{limits(table, context)});
}

Block make_rate_limiter(const Config& table, const BlockContext& context) {
  return through(
      RateLimiter{limits(table, context), context.period, std::vector<double>(context.axes())});
}

Block make_switch(const Config& table, const BlockContext&) {
  Block block = through(Switch{});
  block.inputs = {{"in1"}, {"in2"}};
  add_parameter(block, table, "first", "1", 1);
  return block;
}

Block make_unit_delay(const Config&, const BlockContext& context) {
  return through(UnitDelay{std::vector<double>(context.axes())});
}

Block make_transport_delay(const Config& table, const BlockContext& context) {
  const double delay = table.number_in("delay_s", context.period, 10);
  const auto steps = static_cast<std::size_t>(std::lround(delay / context.period));
  return through(TransportDelay{std::vector<double>(steps * context.axes())});
}

Block make_derivative(const Config& table, const BlockContext& context) {
  Block block = through(Derivative{context.period, std::vector<double>(context.axes())});
  block.outputs[0].unit = table.text("unit");
  return block;
}

Block make_low_pass(const Config& table, const BlockContext& context) {
  const int order = static_cast<int>(table.integer_in("order", 2, 8, 2));
  const double cutoff = table.number("cutoff_Hz");
  const auto filter = table.placed("cutoff_Hz", [&] {
    return controller::LowPass{order, cutoff, context.period};
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

controller::Polynomial read_polynomial(const Config& table, const std::string& key) {
  const std::string name = table.text(key, "D2");
  if (const auto polynomial = controller::polynomial_from_text(name)) return *polynomial;
  table.fail(key, fmt::format("{} is '{}', expected P0 to P3, D1 to D3, DV or DVA", key, name));
}

std::vector<int> read_sampling_delay(const Config& table, const BlockContext& context,
                                     int substeps) {
  std::vector<int> delays;
  for (const double delay : per_axis(table, "sampling_delay_s", context, 0)) {
    const int in_substeps = static_cast<int>(std::lround(delay / context.period));
    const double ratio = static_cast<double>(in_substeps) / substeps;
    switch (controller::judge_delay(in_substeps, substeps)) {
      case controller::DelayVerdict::Fine:
        break;
      case controller::DelayVerdict::Warned:
        fmt::print(stderr, "{}: warning: the sampling delay is {:.2f} of the step, above 0.6\n",
                   table.where("sampling_delay_s"), ratio);
        break;
      case controller::DelayVerdict::Refused:
        table.fail(
            "sampling_delay_s",
            fmt::format("the sampling delay is {:.2f} of the step, expected less than 0.8", ratio));
    }
    delays.push_back(in_substeps);
  }
  return delays;
}

Block make_predictor_corrector(const Config& table, const BlockContext& context) {
  controller::PredictorCorrectorSettings settings;
  settings.axes = static_cast<int>(context.axes());
  settings.integration_step = context.run.integration_step;
  settings.simulation_step = context.run.simulation_step;
  settings.substeps = static_cast<int>(std::lround(settings.simulation_step / context.period));
  settings.slow_down_from = table.number_in("slow_down_from", 0.1, 0.95, settings.slow_down_from);
  settings.predictor = read_polynomial(table, "predictor");
  settings.corrector = read_polynomial(table, "corrector");
  settings.targets_carry_rates = table.flag("targets_carry_rates", false);
  settings.largest_xi = table.number_in("largest_xi", 0.1, 0.99, settings.largest_xi);
  Block block;
  block.inputs = {{"new_target", kSingle, "1"},
                  {"target", kPerAxis, "m"},
                  {"displacement", kPerAxis, "m"},
                  {"force", kPerAxis, "N"},
                  {"target_velocity", kPerAxis, "m/s", true},
                  {"target_acceleration", kPerAxis, "m/s2", true}};
  block.outputs = {{"command", kPerAxis, "m"},         {"velocity", kPerAxis, "m/s"},
                   {"acceleration", kPerAxis, "m/s2"}, {"held_displacement", kPerAxis, "m"},
                   {"held_force", kPerAxis, "N"},      {"at_target", kSingle, "1"},
                   {"switch_pc", kSingle, "1"},        {"state", kSingle, "1"},
                   {"counter", kSingle, "1"},          {"stopped", kSingle, "1"},
                   {"correct_time", kSingle, "s"},     {"predict_time", kSingle, "s"},
                   {"slow_down_time", kSingle, "s"},   {"targets", kSingle, "1"}};
  const auto delays = read_sampling_delay(table, context, settings.substeps);
  block.kind = table.placed("name", [&] {
    return PredictorCorrectorBlock{settings, delays, context.period};
  });
  return block;
}

Eigen::Vector3d three(const Config& table, const std::string& key,
                      const Eigen::Vector3d& otherwise) {
  const auto values = table.numbers(key, {otherwise[0], otherwise[1], otherwise[2]});
  if (values.size() != 3)
    table.fail(key,
               fmt::format("{} has {} numbers, expected three: a0, a1, a2", key, values.size()));
  return {values[0], values[1], values[2]};
}

Block make_ats(const Config& table, const BlockContext& context) {
  controller::AtsSettings settings;
  settings.period = context.period;
  settings.initial = three(table, "initial", settings.initial);
  settings.lowest = three(table, "lowest", settings.lowest);
  settings.highest = three(table, "highest", settings.highest);
  settings.largest_change = three(table, "largest_change", settings.largest_change);
  settings.threshold = table.number_in("threshold_m", 0, 1, settings.threshold);
  settings.window = table.number_in("window_s", 0.01, 100, settings.window);
  settings.decimation =
      static_cast<int>(table.integer_in("decimation", 1, 1000, settings.decimation));
  settings.filter_order =
      static_cast<int>(table.integer_in("filter_order", 2, 8, settings.filter_order));
  settings.filter_cutoff = table.number_in("filter_cutoff_Hz", 0.1, 1000, settings.filter_cutoff);
  settings.smoothing = static_cast<int>(table.integer_in("smoothing", 1, 100, settings.smoothing));
  settings.quiet_rms = table.number_in("quiet_rms_m", 0, 1, settings.quiet_rms);
  Block block;
  block.inputs = {{"command", kPerAxis, "m"},
                  {"velocity", kPerAxis, "m/s"},
                  {"acceleration", kPerAxis, "m/s2"},
                  {"measured", kPerAxis, "m"}};
  block.outputs = {{"reference", kPerAxis, "m"},
                   {"a0", kPerAxis, "1"},
                   {"a1", kPerAxis, "s"},
                   {"a2", kPerAxis, "s2"},
                   {"limited", kPerAxis, "1"}};
  add_parameter(block, table, "enabled", "1", 1);
  add_parameter(block, table, "adapt", "1", 1);
  const auto ats = table.placed("name", [&] { return controller::Ats{settings}; });
  block.kind = AtsBlock{std::vector(context.axes(), ats)};
  return block;
}

Block make_feed_forward(const Config& table, const BlockContext&) {
  Block block;
  block.inputs = {{"reference", kPerAxis, "m"},
                  {"velocity", kPerAxis, "m/s"},
                  {"acceleration", kPerAxis, "m/s2"}};
  block.outputs = {{"reference", kPerAxis, "m"}};
  add_parameter(block, table, "enabled", "1", 1);
  add_parameter(block, table, "velocity_gain_s", "s", 0);
  add_parameter(block, table, "acceleration_gain_s2", "s2", 0);
  block.kind = FeedForwardBlock{};
  return block;
}

Block make_force_observer(const Config& table, const BlockContext& context) {
  const auto mass = per_axis(table, "effective_mass_kg", context, 0);
  const auto coulomb = per_axis(table, "coulomb_friction_N", context, 0);
  const auto viscous = per_axis(table, "viscous_friction_N_s_per_m", context, 0);
  const auto offset = per_axis(table, "force_offset_N", context, 0);
  const double exponent = table.number_in("exponent", 0.1, 2, 1.0);
  const double rest = table.number_in("rest_velocity_m_per_s", 0, 1, 1.27e-3);
  const int length = static_cast<int>(table.integer_in("slope_samples", 3, 1000, 32));
  ForceObserverBlock observer;
  for (std::size_t i = 0; i < context.axes(); ++i)
    observer.observers.emplace_back(
        controller::MachineForce{mass[i], coulomb[i], viscous[i], exponent, offset[i], rest},
        context.period, length);
  Block block;
  block.inputs = {{"displacement", kPerAxis, "m"},
                  {"acceleration", kPerAxis, "m/s2"},
                  {"force", kPerAxis, "N"}};
  block.outputs = {
      {"force", kPerAxis, "N"}, {"velocity", kPerAxis, "m/s"}, {"machine_force", kPerAxis, "N"}};
  add_parameter(block, table, "enabled", "1", 1);
  block.kind = std::move(observer);
  return block;
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
                                     {"feed_forward", make_feed_forward},
                                     {"force_observer", make_force_observer},
                                     {"stop", make_stop}};

const BlockType& type_named(const Config& table) {
  const std::string name = table.text("type");
  std::vector<std::string> known;
  for (const auto& type : kBlockTypes) {
    if (type.name == name) return type;
    known.emplace_back(type.name);
  }
  const auto meant = memmap::nearest(name, known);
  table.fail("type", fmt::format("there is no block type '{}'{}", name,
                                 meant ? fmt::format(" (did you mean '{}'?)", *meant) : ""));
}

void read_wires(const Config& table, Block& block) {
  const Config wires = table.table_or_empty("in");
  for (const auto& input : block.inputs)
    block.wires.push_back(input.optional ? wires.text(input.name, "") : wires.text(input.name));
  wires.reject_unknown_keys();
}

}  // namespace

Block make_block(const Config& table, const DiagramContext& run, double base_period, int substeps) {
  const std::string name = table.text("name");
  const std::int64_t rate = table.integer("rate", 1);
  if (rate != 1 && rate != substeps)
    table.fail("rate", fmt::format("rate is {}, expected 1 or {}", rate, substeps));
  const BlockContext context{run, base_period / static_cast<double>(rate)};
  Block block = type_named(table).make(table, context);
  block.name = name;
  block.where = table.where();
  block.fast = rate != 1;
  read_wires(table, block);
  table.reject_unknown_keys();
  return block;
}

}  // namespace rths::adapters

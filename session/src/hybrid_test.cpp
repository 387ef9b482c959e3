// SPDX-License-Identifier: Apache-2.0
#include <rths/session/hybrid_test.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <rths/budget/transfer_system.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/block_settings.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "recorded_host.hpp"

namespace rths::session {
namespace {

using experiment::NodePlan;
using recording::at_each_count;
using recording::AxisRoles;
using recording::NodeTicks;
using recording::Reader;
using recording::Roles;

// Words of a tested axis; null for another.
const AxisRoles* axis_of(const Roles& roles, const std::string& axis) {
  for (const auto& words : roles.axes)
    if (words.axis == axis) return &words;
  return nullptr;
}

const NodePlan& controller_of(const Experiment& experiment) {
  for (const auto& plan : experiment.nodes)
    if (plan.node == experiment.roles.controller && plan.table.has("diagram")) return plan;
  throw Error{experiment.file.string() + ": the controller runs no block diagram"};
}

double first_value(const Reader& run, const std::string& signal, double otherwise) {
  if (!run.has(signal)) return otherwise;
  const auto values = run.signal(signal);
  return values.empty() ? otherwise : values.front();
}

std::vector<double> ticks_or(const Reader& run, const NodeTicks& ticks, const std::string& signal,
                             double otherwise) {
  return run.has(signal) ? ticks.values(signal) : std::vector<double>(ticks.count(), otherwise);
}

std::vector<std::string> tested_axes(const budget::HybridTest& test) {
  std::vector<std::string> axes;
  for (std::size_t i = 0; i < 2; ++i)
    if (test.tested[i]) axes.emplace_back(name_of(kHorizontal[i]));
  return axes;
}

// Values of the tested axes in their places; a list of a diagram need not hold others.
template <class Value>
std::array<Value, 2> by_axis(const budget::HybridTest& test, const std::vector<Value>& values) {
  std::array<Value, 2> placed{};
  auto next = values.begin();
  for (std::size_t i = 0; i < 2; ++i)
    if (test.tested[i]) placed[i] = *next++;
  return placed;
}

void read_command(const Config& block, budget::HybridTest& test) {
  const int substeps = test.command.substeps;
  const double substep = test.rate * test.integration_step / substeps;
  test.command = experiment::predictor_corrector_settings(block);
  test.command.substeps = substeps;
  test.sampling_delay =
      by_axis(test, experiment::sampling_delays(block, tested_axes(test), substep));
}

void read_block(const Config& block, budget::HybridTest& test) {
  const auto axes = tested_axes(test);
  const std::string type = block.text("type", "");
  if (type == "predictor_corrector") read_command(block, test);
  if (type == "target_force") {  // of the loop, which has both axes
    test.target_force = experiment::target_force_settings(block, names_of(kHorizontal), test.period,
                                                          test.rate * test.integration_step,
                                                          &test.specimen_simulated);
    test.target_force_waits =
        block.table_or_empty("in").text("displacement", "").ends_with(".displacement");
  }
  if (type == "force_observer") {
    const auto found = experiment::force_observer_settings(block, axes);
    test.correction =
        loop::MachineForceCorrection{by_axis(test, found.machine), found.slope_samples};
  }
  if (type == "table_force_observer") {
    const auto found = experiment::table_force_observer_settings(block, axes, test.period);
    test.correction = loop::TableForceCorrection{by_axis(test, found.machine), found.observer};
  }
}

std::vector<Config> read_diagram(const NodePlan& plan, budget::HybridTest& test) {
  const auto choice = experiment::read_diagram_choice(plan.table);
  const Config diagram = Config::load(choice.diagram);
  const double step = test.rate * test.integration_step;
  test.period = to_seconds(plan.schedule.period);
  const bool is_one_tick = experiment::is_one_tick(step, test.period);
  const double substeps = is_one_tick ? 1 : static_cast<double>(diagram.integer("substeps", 1));
  test.command.substeps = static_cast<int>(std::lround(step / (test.period / substeps)));
  auto blocks = experiment::blocks_of(diagram, choice.constants, choice.blocks);
  std::erase_if(blocks, [](const Config& block) {
    return block.flag("single", false);  // of the vertical force
  });
  for (const auto& block : blocks) read_block(block, test);
  return blocks;
}

/// What the controller recorded of its own in a run.
struct Recorded {
  const Reader& run;
  const NodeTicks& ticks;
  const Roles& roles;

  [[nodiscard]] std::string monitor(const std::string& block, const std::string& output) const {
    return roles.monitor_of_controller() + block + "." + output;
  }
  [[nodiscard]] double tuned(const std::string& parameter, double otherwise) const {
    return first_value(run, "tune." + roles.controller + "." + parameter, otherwise);
  }
};

// The lead as sent: coefficients of ATS and the gains of the feed-forward.
std::vector<budget::Lead> lead_of(const Recorded& by, const std::string& axis) {
  const bool leads = by.tuned("feed_forward.enabled", 0) != 0;
  const double velocity = leads ? by.tuned("feed_forward.velocity_gain_s", 0) : 0;
  const double acceleration = leads ? by.tuned("feed_forward.acceleration_gain_s2", 0) : 0;
  std::vector<budget::Lead> lead(by.ticks.count(), budget::Lead{1, velocity, acceleration});
  const auto monitor = [&](const char* name) { return by.monitor("ats", name + ("." + axis)); };
  if (!by.run.has(monitor("a0")) || by.tuned("ats.enabled", 1) == 0) return lead;
  const auto a0 = by.ticks.values(monitor("a0"));
  const auto a1 = by.ticks.values(monitor("a1"));
  const auto a2 = by.ticks.values(monitor("a2"));
  for (std::size_t i = 0; i < lead.size(); ++i)
    lead[i] = {a0[i], a1[i] + velocity, a2[i] + acceleration};
  return lead;
}

// The coefficients of an adaptive inverse as sent, in the order of its terms.
budget::SentInverse inverse_of(const Recorded& by, const Config& block, std::size_t axis,
                               double period) {
  const auto settings =
      experiment::adaptive_inverse_settings(block, {name_of(kHorizontal[axis])}, period).front();
  const auto initial = controller::InverseLead::vector_of(settings.initial);
  budget::SentInverse sent{settings, {}};
  sent.coefficients.assign(by.ticks.count(), initial);
  for (Eigen::Index i = 0; i < initial.size(); ++i) {
    const std::string output =
        std::string{controller::kInverseCoefficients[i].output} + "." + name_of(kHorizontal[axis]);
    const auto values =
        ticks_or(by.run, by.ticks, by.monitor(block.text("name"), output), initial[i]);
    for (std::size_t tick = 0; tick < values.size(); ++tick)
      sent.coefficients[tick][i] = values[tick];
  }
  return sent;
}

budget::Compensation compensation_of(const Recorded& by, const std::vector<Config>& blocks,
                                     std::size_t axis, double period) {
  for (const auto& block : blocks)
    if (block.text("type", "") == "adaptive_inverse" &&
        by.tuned(block.text("name") + ".enabled", 1) != 0)
      return inverse_of(by, block, axis, period);
  return lead_of(by, name_of(kHorizontal[axis]));
}

double relative_difference(const std::vector<double>& wanted, const std::vector<double>& found) {
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    apart += (found[i] - wanted[i]) * (found[i] - wanted[i]);
    all += wanted[i] * wanted[i];
  }
  return all > 0 ? std::sqrt(apart / all) : 0;
}

}  // namespace

loop::ForceCorrection correction_of(const Experiment& experiment) {
  budget::HybridTest test;
  test.tested = horizontal_among(experiment.axes);
  static_cast<void>(read_diagram(controller_of(experiment), test));
  return test.correction;
}

budget::HybridTest hybrid_test_of(const Experiment& experiment, const Reader& run) {
  budget::HybridTest test;
  test.structure = experiment.plant.structure;
  test.motion = experiment.tested_motion();
  test.alpha = experiment.solver.alpha;
  test.substeps = experiment.solver.substeps;
  test.implicit_stiffness = sim::initial_stiffness(experiment.model.bearing);
  test.duration = experiment.time.duration;
  test.integration_step = experiment.time.integration_step;
  test.rate = experiment.time.rate;
  const Roles& roles = experiment.roles;
  const NodeTicks ticks{run, roles.controller};
  test.tested = horizontal_among(experiment.axes);
  test.specimen_simulated = test.specimen_identified = experiment.model.bearing;
  test.machine_simulated = test.machine_identified = experiment.model.machine;
  const auto blocks = read_diagram(controller_of(experiment), test);
  const Recorded by{run, ticks, roles};
  if (by.tuned("target_force.enabled", 1) == 0) test.target_force.reset();
  for (std::size_t i = 0; i < 2; ++i)
    if (test.tested[i]) test.compensation[i] = compensation_of(by, blocks, i, test.period);
  const NodeTicks machine{run, roles.machine};
  test.host = recorded_host(experiment, run, ticks, test.period);
  test.axial_load =
      ticks_or(run, machine, roles.vertical_force, experiment.model.bearing.axial_load);
  return test;
}

budget::Response response_of(const Experiment& experiment, const Reader& run) {
  const auto targets = run.signal(experiment.roles.monitor_of_controller() + "pc.targets");
  budget::Response response;
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisRoles* axis = axis_of(experiment.roles, name_of(kHorizontal[i]));
    response[i] = at_each_count(targets, axis != nullptr && run.has(axis->target)
                                             ? run.signal(axis->target)
                                             : std::vector<double>(targets.size(), 0));
    const auto steps = static_cast<std::size_t>(
        std::llround(experiment.time.duration / experiment.time.integration_step));
    if (response[i].size() > steps) response[i].resize(steps);
  }
  return response;
}

std::array<std::vector<double>, 2> fed_force_of(const Experiment& experiment, const Reader& run) {
  const auto steps = run.signal("monitor." + experiment.roles.solver + ".step");
  std::array<std::vector<double>, 2> force;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string signal =
        experiment.roles.monitor_of_controller() + "pc.held_force." + name_of(kHorizontal[i]);
    force[i] = run.has(signal) ? at_each_count(steps, run.signal(signal))
                               : std::vector<double>(steps.size(), 0);
  }
  return force;
}

sim::TransferRecord transfer_record_of(const Roles& roles, const Reader& run,
                                       const std::string& axis, const loop::TickOrder& order) {
  const AxisRoles* words = axis_of(roles, axis);
  if (words == nullptr) throw Error{"the run does not test the axis '" + axis + "'"};
  const NodeTicks ticks{run, roles.machine};
  sim::TransferRecord record;
  record.period = ticks.interval();
  record.reference = ticks.values(words->reference_echo);
  // A machine that is late makes its missed ticks at once, between two rows of the recording.
  if (!order.controller_before.empty()) {
    const auto sent = NodeTicks{run, roles.controller}.values(words->reference);
    for (std::size_t i = 0; i < record.reference.size(); ++i)
      if (const std::size_t made = order.controller_ticks(i); made >= 1 && made <= sent.size())
        record.reference[i] = sent[made - 1];
  }
  record.displacement = ticks.values(words->machine_displacement);
  record.acceleration = ticks.values(words->machine_acceleration);
  record.force = ticks.values(words->machine_force);
  return record;
}

budget::MismatchBudget budget_of_run(const Experiment& experiment, const Experiment& improved,
                                     const Reader& run, const Reader* held_out) {
  if (!experiment.integrates_plant())
    throw Error{experiment.file.string() +
                ": no node integrates the plant as a mismatch budget repeats it"};
  check_gaps(experiment, run, "the recording");
  if (held_out != nullptr) check_gaps(experiment, *held_out, "the held-out recording");
  auto test = hybrid_test_of(experiment, run);
  if (test.command.targets_carry_rates)
    throw Error{experiment.file.string() +
                ": the targets carry rates, which a mismatch budget does not repeat"};
  test.specimen_identified = improved.model.bearing;
  test.machine_identified = improved.model.machine;
  std::array<sim::TransferRecord, 2> records;
  for (std::size_t i = 0; i < 2; ++i)
    if (test.tested[i])
      records[i] =
          transfer_record_of(experiment.roles, run, name_of(kHorizontal[i]), test.host.order);
  auto found = budget::mismatch_budget(std::move(test), response_of(experiment, run), records,
                                       fed_force_of(experiment, run));
  const Roles& roles = experiment.roles;
  found.times = at_each_count(run.signal(roles.monitor_of_controller() + "pc.targets"), run.time());
  const NodeTicks ticks{run, roles.controller};
  for (auto& axis : found.axes) {
    const AxisRoles* words = axis_of(roles, name_of(axis.axis));
    axis.tracking =
        relative_difference(ticks.values(words->command), ticks.values(words->displacement));
    if (held_out == nullptr) continue;
    const auto unseen = transfer_record_of(roles, *held_out, name_of(axis.axis), {});
    axis.held_out = budget::error_on(axis.transfer, unseen);
    axis.held_out_without = relative_difference(unseen.displacement, unseen.reference);
  }
  return found;
}

}  // namespace rths::session

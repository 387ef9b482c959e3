// SPDX-License-Identifier: Apache-2.0
//
// Companion runs of a hybrid test: the same displacement history without compensation, the same
// test under another earthquake, and the purely numerical result.
#include <rths/session/companions.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/loop/numerical_response.hpp>
#include <rths/recording/roles.hpp>
#include <rths/recording/step_at.hpp>

#include "virtual_run.hpp"

namespace rths::session {
namespace {

using experiment::kReferenceStep;
using experiment::NodePlan;
// Targets of an axis; zeros if it is not tested.
std::vector<double> targets_of(const Experiment& experiment, const recording::Reader& reader,
                               const std::string& axis) {
  for (const auto& roles : experiment.roles.axes)
    if (roles.axis == axis && reader.has(roles.target)) return reader.signal(roles.target);
  return std::vector<double>(reader.rows(), 0.0);
}

// Index of the target in each row: counted by the solver, or from its time, or counted by the
// controller.
std::vector<double> recorded_steps(const Experiment& experiment, const recording::Reader& reader) {
  for (const auto& plan : experiment.nodes)
    if (const auto& count = plan.settings.solver.target_count; !count.empty())
      return reader.signal("monitor." + plan.node + "." + count);
  const auto roles = recording::roles_of(reader);
  const auto counted = roles.monitor_of_controller() + "pc.targets";
  auto steps = reader.signal(reader.has(roles.time) ? roles.time : counted);
  // A user's own solver may not write its time.
  if (steps.back() <= 0 && reader.has(counted)) return reader.signal(counted);
  for (double& step : steps) step /= experiment.time.integration_step;
  return steps;
}

// One target per integration step, taken at the row where the index changes.
experiment::DisplacementHistory recorded_targets(const Experiment& experiment,
                                                 const std::filesystem::path& file) {
  const recording::Reader reader{file};
  const auto steps = recorded_steps(experiment, reader);
  const auto along = targets_of(experiment, reader, name_of(kHorizontal[0]));
  const auto across = targets_of(experiment, reader, name_of(kHorizontal[1]));
  experiment::DisplacementHistory history;
  history.time_step = experiment.time.integration_step;
  history.displacement_long = {0};
  history.displacement_lat = {0};
  const double last = experiment.time.duration / experiment.time.integration_step + 1;
  for (std::size_t row = 0; row < steps.size(); ++row) {
    if (!(steps[row] >= 0 && steps[row] <= last)) continue;  // of a user's own solver
    const auto step = static_cast<std::size_t>(std::lround(steps[row]));
    if (step < history.displacement_long.size()) continue;
    // A missing row repeats the last known target.
    history.displacement_long.resize(step + 1, history.displacement_long.back());
    history.displacement_lat.resize(step + 1, history.displacement_lat.back());
    history.displacement_long[step] = along[row];
    history.displacement_lat[step] = across[row];
  }
  return history;
}

// The project's own solver imposes the recorded targets in place of a user's.
// @returns whether all nodes then have virtual time
bool replace_user_solver(Experiment& experiment) {
  const memmap::Map map = memmap::load_map(experiment.map);
  const auto target = map.find_signal(experiment.roles.new_target);
  for (auto& plan : experiment.nodes) {
    if (!plan.settings.program) continue;
    if (!target || map.entry(*target).partition->node != plan.node) return false;
    plan.settings.program.reset();
  }
  return true;
}

// Writes results of an analysis as a recording, with a map made for them.
class ResultMap {
 public:
  void add(const std::string& name, const char* unit, const std::vector<double>& values) {
    memmap::Signal signal;
    signal.name = name;
    signal.unit = unit;
    signal.offset = LongwordOffset{static_cast<std::uint32_t>(partition_.signals.size())};
    partition_.signals.push_back(signal);
    columns_.push_back(&values);
  }

  void write(const std::filesystem::path& file, double time_step,
             const recording::RecordingInfo& info) {
    memmap::MapDescription description;
    description.name = "numerical";
    description.size_longwords = 1024;
    description.nodes = {{"analysis", NodeId{1}, ""}};
    partition_.name = "result";
    partition_.node = "analysis";
    partition_.longwords = static_cast<std::uint32_t>(partition_.signals.size());
    description.partitions = {partition_};
    const memmap::Map map{description};
    std::vector<SignalId> signals;
    for (std::uint32_t i = 0; i < columns_.size(); ++i) signals.push_back(SignalId{i});
    recording::Writer writer{file, map, signals, info};
    std::vector<double> row(columns_.size());
    for (std::size_t i = 0; i < columns_[0]->size(); ++i) {
      for (std::size_t c = 0; c < columns_.size(); ++c) row[c] = (*columns_[c])[i];
      writer.append(from_seconds(static_cast<double>(i + 1) * time_step), row);
    }
    writer.close();
  }

 private:
  memmap::Partition partition_;
  std::vector<const std::vector<double>*> columns_;
};

using Floors = std::vector<loop::ResponseHistory::Floor>;

void add_floors(ResultMap& result, const std::string& prefix, const Floors& floors) {
  for (std::size_t i = 0; i < floors.size(); ++i) {
    const auto& floor = floors[i];
    const std::string name = fmt::format("{}floor.{}.accel.", prefix, i + 1);
    result.add(name + name_of(kHorizontal[0]), "m/s2", floor.acceleration_long);
    result.add(name + name_of(kHorizontal[1]), "m/s2", floor.acceleration_lat);
  }
}

std::string names_of(const Floors& floors) {
  std::string names;
  for (const auto& floor : floors) names += floor.name + "\n";
  return names;
}

/// Acceleration of the ground, long and lat, at equal intervals [m/s²]; the first row is one
/// interval after the start.
std::array<std::vector<double>, 2> ground_of(const sim::GroundMotion& motion, double interval,
                                             std::size_t count) {
  std::array<std::vector<double>, 2> ground;
  for (std::size_t i = 1; i <= count; ++i) {
    const Eigen::Vector2d acceleration = motion.at(static_cast<double>(i) * interval);
    ground[0].push_back(acceleration[0]);
    ground[1].push_back(acceleration[1]);
  }
  return ground;
}

void run_companion(const Experiment& experiment, const std::filesystem::path& recording,
                   const std::string& version) {
  const launch::RunOutcome outcome = run_virtually(experiment, recording, version);
  if (outcome.completed) return;
  std::error_code ignored;
  std::filesystem::remove(recording, ignored);  // no report must take it for a whole run
  stop_if_interrupted();
  throw Error{fmt::format("the run {} failed: {}", experiment.companion, outcome.trouble)};
}

// The project's own structure, isolated and on a fixed base.
void write_analysis(const Experiment& experiment, const std::filesystem::path& recording) {
  const sim::StructureModel& structure = *experiment.plant.structure;
  const sim::GroundMotion motion = experiment.tested_motion();
  const auto isolated = loop::numerical_response(structure, motion, experiment.model.bearing,
                                                 kReferenceStep, experiment.time.duration);
  const auto fixed =
      loop::fixed_base_response(structure, motion, kReferenceStep, experiment.time.duration);
  const auto ground = ground_of(motion, kReferenceStep, isolated.displacement_long.size());
  ResultMap result;
  result.add("displ.long", "m", isolated.displacement_long);
  result.add("displ.lat", "m", isolated.displacement_lat);
  result.add("force.long", "N", isolated.force_long);
  result.add("force.lat", "N", isolated.force_lat);
  result.add("ground.accel.long", "m/s2", ground[0]);
  result.add("ground.accel.lat", "m/s2", ground[1]);
  add_floors(result, "isolated.", isolated.floors);
  add_floors(result, "fixed.", fixed.floors);
  result.write(recording, kReferenceStep, {{{"floors", names_of(isolated.floors)}}, {}, {}});
}

/// Displacement and force of the bearing at equal intervals, long and lat; the first row is one
/// interval after the start.
struct BearingResponse {
  double interval = 0;  ///< [s]
  std::array<std::vector<double>, 2> displacement, force;
  Floors floors = {};
  std::array<std::vector<double>, 2> ground = {};  ///< acceleration, beside floors [m/s²]
  void write(const std::filesystem::path& recording) const {
    ResultMap result;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::string name = name_of(kHorizontal[axis]);
      result.add("displ." + name, "m", displacement[axis]);
      result.add("force." + name, "N", force[axis]);
      if (!floors.empty()) result.add("ground.accel." + name, "m/s2", ground[axis]);
    }
    add_floors(result, "isolated.", floors);
    result.write(recording, interval, {{{"floors", names_of(floors)}}, {}, {}});
  }
};

// The force is that of the model under the stated motion.
void write_reference(const Experiment& experiment, const std::filesystem::path& recording) {
  const auto& stated = *experiment.reference;
  BearingResponse response{stated.time_step, {}, {}, {}, {}};
  sim::BearingRun bearing{experiment.model.bearing, stated.time_step};
  const std::array<const std::vector<double>*, 2> motion{&stated.displacement_long,
                                                         &stated.displacement_lat};
  for (std::size_t row = 1; row < motion[0]->size(); ++row) {
    Eigen::Vector2d displacement, before;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      displacement[static_cast<Eigen::Index>(axis)] = (*motion[axis])[row];
      before[static_cast<Eigen::Index>(axis)] = (*motion[axis])[row - 1];
    }
    const Eigen::Vector2d force =
        bearing.advance(displacement, (displacement - before) / stated.time_step,
                        experiment.model.bearing.axial_load);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      response.displacement[axis].push_back(displacement[static_cast<Eigen::Index>(axis)]);
      response.force[axis].push_back(force[static_cast<Eigen::Index>(axis)]);
    }
  }
  response.write(recording);
}

// The test with an ideal machine in place of controller and machine, and the model in place of the
// specimen. The recording's rows must resolve the steps, so short ones take longer.
Experiment with_ideal_machine(const Experiment& experiment, const NodePlan& solver) {
  constexpr double kLeastStep = 0.01;  // [s]
  Experiment ideal = experiment;
  ideal.companion = "with an ideal machine";
  ideal.time.rate = std::max(1.0, kLeastStep / experiment.time.integration_step);
  ideal.time.rest = 0;
  ideal.specimen = ideal.machine.simulated.specimen = experiment.model.bearing;
  ideal.solver.models_computing_time = false;
  ideal.cards.reset();
  ideal.network.hosts.clear();
  ideal.role_table = Config{};
  std::erase_if(ideal.nodes, [&](const NodePlan& plan) {
    return plan.node != solver.node && plan.settings.role != experiment::Role::Recorder;
  });
  const memmap::Map map = memmap::load_map(experiment.map);
  const auto& answer = experiment.roles.axes.front().returned_force;
  const auto word = map.find_signal(answer);
  if (!word)
    throw Error{fmt::format("{}: the map has no signal {}, which an ideal machine writes",
                            experiment.file.string(), answer)};
  NodePlan machine;
  machine.node = map.entry(*word).partition->node;
  machine.adapter = "ideal_machine";
  machine.settings = *solver.settings.solver.ideal_machine;
  machine.schedule = machine.settings.schedule;
  ideal.nodes.push_back(std::move(machine));
  for (auto& plan : ideal.nodes) plan.host.clear();
  std::stable_sort(ideal.nodes.begin(), ideal.nodes.end(),
                   [](const auto& a, const auto& b) { return a.settings.role < b.settings.role; });
  return ideal;
}

// Values at each target, by integration step. A step without a move keeps the value before.
std::vector<double> by_step(const std::vector<double>& times, const std::vector<double>& values,
                            double step, std::size_t count) {
  std::vector<double> all;
  double value = 0;
  for (std::size_t i = 0; i < std::min(times.size(), values.size()); ++i) {
    const long found = recording::step_at(times[i], step);
    if (found < 0 || found >= static_cast<long>(count)) continue;
    const auto at = static_cast<std::size_t>(found);
    all.resize(std::max(all.size(), at), value);
    value = values[i];
    if (at == all.size())
      all.push_back(value);
    else
      all[at] = value;
  }
  all.resize(count, value);
  return all;
}

BearingResponse response_in(const Experiment& experiment, const recording::Reader& run,
                            const NodePlan& solver) {
  const auto moves = run.signal("monitor." + solver.node + ".step");
  const double step = experiment.time.integration_step;
  const auto count = static_cast<std::size_t>(std::llround(experiment.time.duration / step));
  const auto times = recording::at_each_count(moves, run.signal(experiment.roles.time));
  BearingResponse response{step, {}, {}, {}, {}};
  // What belongs to a target is there when the next one comes.
  const auto answers = [&](const std::string& signal) {
    const auto recorded = run.signal(signal);
    auto values = recording::at_each_count(moves, recorded);
    if (!values.empty()) values.erase(values.begin());
    values.push_back(recorded.back());
    return by_step(times, values, step, count);
  };
  for (std::size_t axis = 0; axis < 2; ++axis) {
    response.displacement[axis].assign(count, 0);
    response.force[axis].assign(count, 0);
    for (const auto& words : experiment.roles.axes) {
      if (words.axis != name_of(kHorizontal[axis])) continue;
      response.displacement[axis] =
          by_step(times, recording::at_each_count(moves, run.signal(words.target)), step, count);
      response.force[axis] = answers(words.returned_force);
    }
  }
  for (std::size_t i = 0; i < solver.settings.solver.floors.size(); ++i) {
    const auto floor = fmt::format("monitor.{}.floor.{}.accel.", solver.node, i + 1);
    response.floors.push_back({solver.settings.solver.floors[i],
                               answers(floor + name_of(kHorizontal[0])),
                               answers(floor + name_of(kHorizontal[1])),
                               {}});
  }
  if (!response.floors.empty())
    response.ground = ground_of(experiment.earthquake.motion, step, count);
  return response;
}

void repeat_solver(const Experiment& experiment, const NodePlan& solver,
                   const std::filesystem::path& recording, const std::string& version) {
  const Experiment ideal = with_ideal_machine(experiment, solver);
  run_companion(ideal, recording, version);
  const auto response = response_in(ideal, recording::Reader{recording}, solver);
  std::filesystem::remove(recording);
  response.write(recording);
}

// The specimen of such a test has no model.
bool answers_as_a_spring(const Experiment& experiment) {
  return std::any_of(experiment.nodes.begin(), experiment.nodes.end(),
                     [](const NodePlan& plan) { return plan.adapter == "echo"; });
}

}  // namespace

bool run_uncompensated(const Experiment& experiment, const std::filesystem::path& history,
                       const std::filesystem::path& recording, const std::string& version) {
  Experiment bare = experiment;
  bool switched_off = false;
  for (auto& node : bare.nodes) {
    switched_off = switched_off || !node.uncompensated.empty();
    node.switch_compensation_off();
  }
  if (!switched_off || !replace_user_solver(bare)) return false;
  bare.history = recorded_targets(experiment, history);
  bare.companion = "without compensation";
  run_companion(bare, recording, version);
  return true;
}

bool run_held_out(const Experiment& experiment, const std::filesystem::path& recording,
                  const std::string& version) {
  if (!experiment.held_out || experiment.has_user_program()) return false;
  Experiment second = experiment;
  second.earthquake.motion = *experiment.held_out;
  renew_noise(second, 1);
  second.companion = "under the second earthquake";
  run_companion(second, recording, version);
  return true;
}

bool run_numerical(const Experiment& experiment, const std::filesystem::path& recording,
                   const std::string& version) {
  if (experiment.reference)
    write_reference(experiment, recording);
  else if (experiment.solves_plant())
    write_analysis(experiment, recording);
  else if (const NodePlan* solver = experiment.repeatable_solver();
           solver != nullptr && !answers_as_a_spring(experiment))
    repeat_solver(experiment, *solver, recording, version);
  else
    return false;
  return true;
}

}  // namespace rths::session

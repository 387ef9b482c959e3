// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/experiment.hpp>

#include "tables.hpp"

namespace rths::experiment {
namespace {

constexpr int kMostSubsteps = 100;  // of the integration between targets

constexpr std::size_t kLongestName = 200;
constexpr double kShortestTest = 1;  // [s]: shorter tests cannot measure delays
// Experiments with different seeds differ in all their noise.
constexpr std::uint64_t kComputingSeed = 1, kTargetSeed = 2;  // beyond that of the machine

// Other files that the commands of this program take.
void require_experiment(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path))
    throw Error{fmt::format("{}: is a folder, expected the file of an experiment", path.string())};
  if (std::filesystem::exists(path) && recording::is_hdf5(path))
    throw Error{
        fmt::format("{}: is a recording, expected an experiment; 'rths report FOLDER' judges "
                    "the folder of a recorded run again",
                    path.string())};
}

// With nodes it is an experiment, whose stray keys are unknown.
void refuse_case(const Config& file) {
  if (file.has("node")) return;
  for (const char* key : {"record", "channels", "run"})
    if (file.has(key))
      file.fail(key, fmt::format("'{}' belongs to a case of the diagnosis, expected an experiment; "
                                 "'rths diagnose' takes a case",
                                 key));
}

// The name of a ring and of a folder.
std::string read_name(const Config& file) {
  const std::string name = file.text("name");
  const bool is_plain = std::none_of(
      name.begin(), name.end(), [](unsigned char c) { return c == '/' || c < ' ' || c == 0x7F; });
  if (!is_plain || name.empty() || name[0] == '.' || name.size() > kLongestName)
    file.fail("name", fmt::format("name is '{}', expected a file name: 1 to {} characters without "
                                  "'/', and no '.' at the start",
                                  name, kLongestName));
  return name;
}

std::vector<std::string> read_axes(const Config& file) {
  const auto axes = file.texts("axes", names_of(kHorizontal));
  const bool known = std::all_of(axes.begin(), axes.end(), [](const auto& axis) {
    return horizontal_axis_named(axis).has_value();
  });
  if (axes.empty() || axes.size() > 2 || !known || (axes.size() == 2 && axes[0] == axes[1]))
    file.fail("axes",
              fmt::format("axes are {}, expected [\"long\"], [\"lat\"] or both", toml_list(axes)));
  return axes;
}

TimePlan read_time(const Config& file) {
  return {file.number_in("integration_step_s", 1e-3, 0.1, 0.01),
          file.number_in("rate", 1, 1000, 1.0), file.number_in("duration_s", kShortestTest, 1e5),
          file.number_in("rest_s", 0, 60, 0.0)};
}

Retreat read_retreat(const Config& table) {
  Retreat retreat;
  retreat.hold = table.number_in("hold_s", 0, 10, retreat.hold);
  retreat.ramp = table.number_in("ramp_s", 0.01, 60, retreat.ramp);
  table.reject_unknown_keys();
  return retreat;
}

double longest_stop(const Experiment& experiment) {
  double longest = experiment.stop.retreat.hold + experiment.stop.retreat.ramp;
  for (const auto& plan : experiment.nodes) longest = std::max(longest, plan.settings.longest_stop);
  return longest;
}

// Of the map and of the experiment.
void read_roles(const Config& file, Experiment& experiment) {
  const Config map_roles = Config::load(experiment.map).table_or_empty("roles");
  if (!map_roles.keys().empty())
    experiment.config.emplace_back(recording::kMapRolesText, map_roles.to_toml());
  static_cast<void>(file.table_or_empty("roles"));
  const Config merged = recording::with_map_roles(file, map_roles);
  experiment.role_table = merged.table_or_empty("roles");
  experiment.roles = recording::read_roles(merged);
}

// The response of another structure would be no expected motion.
void check_targets(const Config& file, const Experiment& experiment) {
  const Config targets = file.table_or_empty("targets");
  if (targets.text("kind", "") != "response" || experiment.solves_plant()) return;
  targets.fail("kind",
               "kind is 'response', but the solver has a structure of its own, expected 'file'");
}

void require_motion(const Config& file, const Experiment& experiment) {
  for (const auto& plan : experiment.nodes)
    if (const auto& fault = plan.settings.solver.motion_fault; !fault.empty())
      file.fail("held_out", fault);
}

std::string text_of(const Overrides& overrides) {
  std::string changes;
  for (const auto& [key, value] : overrides) changes += fmt::format("{}={}\n", key, value);
  return changes;
}

void check_format(const Config& file) {
  const std::int64_t format = file.integer("format");
  if (format != kExperimentFormat)
    file.fail("format",
              fmt::format("format is {}, this program reads {}", format, kExperimentFormat));
}

void read_parts(const Config& file, std::span<const AdapterKind> kinds,
                const std::string& improvement, Experiment& experiment) {
  experiment.name = read_name(file);
  experiment.map = find_file(file, "map", "maps");
  experiment.axes = read_axes(file);
  experiment.time = read_time(file);
  experiment.seed = static_cast<std::uint64_t>(file.integer_in("seed", 0, 1LL << 53, 1));
  read_earthquakes(file, experiment);
  experiment.plant = read_plant(file);
  if (const auto sketch = experiment.plant.structure->sketch())
    experiment.config.emplace_back(recording::kStructureText, structure_text(*sketch));
  read_laboratory(file, improvement, experiment);
  if (file.has("targets"))
    experiment.history =
        read_targets(file.table("targets"), experiment, experiment.seed + kTargetSeed);
  experiment.solver = read_solver(file.table_or_empty("solver"));
  experiment.solver.computing_time.seed = experiment.seed + kComputingSeed;
  experiment.stop.retreat = read_retreat(file.table_or_empty("stop"));
  experiment.nodes = read_nodes(kinds, file.table("node"), experiment);
  experiment.stop.longest = longest_stop(experiment);
  read_ring(file, experiment);
  read_uncompensated(file.table_or_empty("uncompensated"), experiment.nodes);
  experiment.conclusive = file.table_or_empty("conclusive");
  if (file.has("reference")) experiment.reference = read_reference(file.table("reference"));
  read_roles(file, experiment);
}

}  // namespace

Config changed_experiment(const std::filesystem::path& file, const Overrides& overrides) {
  require_experiment(file);
  Config changed = Config::load(file);
  for (const auto& [key, value] : overrides) changed.set(key, value);
  return changed.in_its_folder();
}

Experiment load_experiment(std::span<const AdapterKind> kinds, const std::filesystem::path& path,
                           const Overrides& overrides, const std::string& improvement) {
  const Config file = changed_experiment(path, overrides);
  refuse_case(file);
  check_format(file);
  Experiment experiment;
  experiment.file = path;
  experiment.config = {{path.filename().string(), read_file(path, kMostTextBytes)}};
  read_parts(file, kinds, improvement, experiment);
  check_targets(file, experiment);
  check_handshake(file, experiment);
  if (experiment.held_out) require_motion(file, experiment);
  file.reject_unknown_keys();
  check_uses(file, experiment);
  settle_missed_steps(experiment);
  if (!overrides.empty())
    experiment.config.emplace_back(recording::kOverridesText, text_of(overrides));
  return experiment;
}

Solver read_solver(const Config& table) {
  Solver solver;
  solver.alpha = table.number_in("alpha", -1.0 / 3, 0, solver.alpha);
  solver.substeps =
      static_cast<int>(table.integer_in("substeps", 1, kMostSubsteps, solver.substeps));
  solver.wait_deadline = table.number_in("wait_deadline_s", 0.01, 100, solver.wait_deadline);
  auto& time = solver.computing_time;
  solver.models_computing_time = table.flag("model_computing_time", false);
  time.mean = table.number_in("computing_time_s", 0, 10, time.mean);
  time.spread = table.number_in("computing_time_spread", 0, 1, time.spread);
  time.overrun_fraction = table.number_in("overrun_fraction", 0, 1, time.overrun_fraction);
  time.overrun = table.number_in("overrun_s", 0, 10, time.overrun);
  table.reject_unknown_keys();
  return solver;
}

double ComputingTimes::draw() noexcept {
  std::normal_distribution<double> normal{model_.mean, model_.spread * model_.mean};
  std::uniform_real_distribution<double> uniform{0, 1};
  const double usual = std::clamp(normal(random_), 0.0, 2 * model_.mean);
  return usual + (uniform(random_) < model_.overrun_fraction ? model_.overrun : 0);
}

}  // namespace rths::experiment

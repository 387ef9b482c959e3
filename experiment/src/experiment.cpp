// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/experiment.hpp>

#include <arpa/inet.h>

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/ascii.hpp>
#include <rths/core/config.hpp>
#include <rths/core/contains.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/toml_list.hpp>
#include <rths/recording/recording.hpp>

#include "assumed_model.hpp"
#include "motion_check.hpp"
#include "unused_keys.hpp"

namespace rths::experiment {
namespace {

constexpr const char* kDefaultSpecimen = "lprb";
constexpr int kMostSubsteps = 100;  // of the integration between targets
constexpr std::size_t kLongestName = 200;
constexpr std::uint64_t kTargetSeed = 2;  // beyond those of machine and computing time
constexpr double kShortestTest = 1;       // [s]: shorter tests cannot measure delays

using Kinds = std::span<const AdapterKind>;

const AdapterKind& kind_named(Kinds kinds, const Config& table) {
  const std::string name = table.text("adapter");
  std::string known;
  for (const auto& kind : kinds) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string{kind.name};
  }
  table.fail("adapter", fmt::format("there is no adapter '{}', expected one of {}", name, known));
}

// Reads parameters written with dots (ats.enabled = 0) or in tables ([… ats]).
void read_tuning(const Config& table, const std::string& prefix, Tuning& tuning) {
  for (const auto& key : table.keys()) {
    if (table.is_table(key))
      read_tuning(table.table(key), prefix + key + ".", tuning);
    else
      tuning.emplace_back(prefix + key, table.number(key));
  }
}

NodePlan read_node(Kinds kinds, const std::string& node, const Config& table,
                   const TestSetup& setup) {
  const AdapterKind& kind = kind_named(kinds, table);
  NodePlan plan;
  plan.node = node;
  plan.adapter = kind.name;
  plan.host = table.text("host", "");
  plan.settings = kind.read(node, table, setup);
  const auto& usual = plan.settings.schedule;
  plan.schedule.missed = usual.missed;
  plan.schedule.period =
      from_seconds(table.number_in("period_s", 1e-5, 1, to_seconds(usual.period)));
  plan.schedule.phase = from_seconds(table.number_in("phase_s", 0, 1, to_seconds(usual.phase)));
  read_tuning(table.table_or_empty("tune"), "", plan.tune);
  table.reject_unknown_keys();
  return plan;
}

std::vector<NodePlan> read_nodes(Kinds kinds, const Config& table, const TestSetup& setup) {
  std::vector<NodePlan> nodes;
  for (const auto& node : table.keys())
    nodes.push_back(read_node(kinds, node, table.table(node), setup));
  // Receivers start before senders.
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.settings.role < b.settings.role; });
  return nodes;
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

void read_axes(const Config& file, Experiment& experiment) {
  experiment.axes = file.texts("axes", {"long", "lat"});
  const auto& axes = experiment.axes;
  const bool known = std::all_of(axes.begin(), axes.end(),
                                 [](const auto& axis) { return axis == "long" || axis == "lat"; });
  if (axes.empty() || axes.size() > 2 || !known || (axes.size() == 2 && axes[0] == axes[1]))
    file.fail("axes",
              fmt::format("axes are {}, expected [\"long\"], [\"lat\"] or both", toml_list(axes)));
}

void read_steps(const Config& file, Experiment& experiment) {
  experiment.integration_step = file.number_in("integration_step_s", 1e-3, 0.1, 0.01);
  experiment.rate = file.number_in("rate", 1, 1000, 1.0);
  experiment.duration = file.number_in("duration_s", kShortestTest, 1e5);
  experiment.rest = file.number_in("rest_s", 0, 60, 0.0);
  experiment.seed = static_cast<std::uint64_t>(file.integer_in("seed", 0, 1LL << 53, 1));
}

// Its friction may be small, and is fitted.
Config usual_machine() {
  Config usual;
  const auto axes = sim::srmd_machine().axes;
  for (const auto& [key, member] : machine_keys())
    usual.put(key, std::vector<double>{axes[0].*member, axes[1].*member});
  return usual;
}

// Reads the bearing with the changes of the experiment, the machine, and the assumed model of both.
void read_laboratory(const Config& file, Experiment& experiment) {
  const Config changes = file.table_or_empty("specimen");
  const auto path = find_file(changes, "model", "bearings", kDefaultSpecimen);
  const Config bearing = Config::load(path);
  const Config specimen = bearing.overlaid(changes);
  check_units(changes, bearing);
  const Config assumed_changes = file.table_or_empty("model").table_or_empty("specimen");
  if (!assumed_changes.has("model")) check_units(assumed_changes, specimen);
  static_cast<void>(specimen.text("model", ""));
  const double weight = sim::weight_per_bearing(experiment.plant);
  experiment.specimen = sim::read_bearing(specimen, weight);
  experiment.config.emplace_back(path.filename().string(), read_file(path, kMostTextBytes));
  const Config machine = file.table_or_empty("machine");
  check_units(machine, usual_machine());
  experiment.machine = read_machine(machine);
  const auto assumed = read_assumed_model(file.table_or_empty("model"), specimen, machine, weight);
  experiment.model = assumed.bearing;
  experiment.assumed_machine = assumed.machine;
  experiment.config.emplace_back(recording::kModelText, assumed.text);
  if (!assumed.specimen.empty())
    experiment.config.emplace_back(recording::kSpecimenText, assumed.specimen);
}

void read_solver(const Config& table, Experiment& experiment) {
  experiment.alpha = table.number_in("alpha", -1.0 / 3, 0, experiment.alpha);
  experiment.substeps =
      static_cast<int>(table.integer_in("substeps", 1, kMostSubsteps, experiment.substeps));
  experiment.wait_deadline =
      table.number_in("wait_deadline_s", 0.01, 100, experiment.wait_deadline);
  auto& time = experiment.computing_time;
  experiment.model_computing_time = table.flag("model_computing_time", false);
  time.mean = table.number_in("computing_time_s", 0, 10, time.mean);
  time.spread = table.number_in("computing_time_spread", 0, 1, time.spread);
  time.overrun_fraction = table.number_in("overrun_fraction", 0, 1, time.overrun_fraction);
  time.overrun = table.number_in("overrun_s", 0, 10, time.overrun);
  table.reject_unknown_keys();
}

void add_remarks(const std::vector<std::string>& remarks, Experiment& experiment) {
  experiment.remarks.insert(experiment.remarks.end(), remarks.begin(), remarks.end());
}

// A test with commanded displacements needs no ground motion.
void read_ground_motion(const Config& file, Experiment& experiment) {
  const bool is_response = file.table_or_empty("targets").text("kind", "") == "response";
  if (file.has("targets") && !file.has("motion") && !is_response) {
    experiment.motion_name = "commanded displacements";
    experiment.motion = {experiment.integration_step, {0, 0}, {0, 0}};
    return;
  }
  const Config motion = file.table("motion");
  experiment.motion_name = motion.text("name", motion.text("file", ""));
  experiment.motion = read_motion(motion);
  add_remarks(check_motion(motion, experiment.motion, experiment.axes), experiment);
}

void read_stop(const Config& table, Experiment& experiment) {
  experiment.retreat.hold = table.number_in("hold_s", 0, 10, experiment.retreat.hold);
  experiment.retreat.ramp = table.number_in("ramp_s", 0.01, 60, experiment.retreat.ramp);
  table.reject_unknown_keys();
}

// Fidelity of the ring, its cards and their faults.
void read_ring(const Config& file, Experiment& experiment) {
  const std::string fidelity = file.text("fidelity", "shared");
  if (fidelity != "shared" && fidelity != "replicated")
    file.fail("fidelity", fmt::format("fidelity is '{}', expected shared or replicated", fidelity));
  const bool is_replicated = fidelity == "replicated";
  for (const char* key : {"cards", "fault"})
    if (file.has(key) && !is_replicated)
      file.fail(key,
                fmt::format("found {} on a shared ring, expected fidelity = \"replicated\"", key));
  if (!is_replicated) return;
  if (!experiment.hosts.empty())
    file.fail("fidelity", "fidelity is 'replicated', expected 'shared' on several hosts");
  experiment.cards = Cards{file.table_or_empty("cards"), file.tables("fault")};
}

// A part of the names of nodes and signals.
bool is_host_name(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(),
                                      [](char c) { return is_letter_or_digit(c) || c == '_'; });
}

bool is_ip_address(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

void read_hosts(const Config& file, Experiment& experiment) {
  const Config hosts = file.table_or_empty("host");
  for (const auto& name : hosts.keys()) {
    if (!is_host_name(name))
      hosts.fail(name,
                 fmt::format("the host's name is '{}', expected letters, digits and '_'", name));
    const Config table = hosts.table(name);
    HostPlan host{name, table.text("address", ""), table.text("interface", "")};
    if (host.interface.empty() && is_ip_address(host.address)) host.interface = host.address;
    table.reject_unknown_keys();
    experiment.hosts.push_back(std::move(host));
  }
  if (experiment.hosts.size() == 1)
    hosts.fail(experiment.hosts[0].name, "there is one host, expected none or at least two");
  std::sort(experiment.hosts.begin(), experiment.hosts.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  const Config network = file.table_or_empty("network");
  experiment.domain = static_cast<std::uint32_t>(network.integer_in("domain", 0, 230, 0));
  experiment.host_deadline = network.number_in("deadline_s", 0.1, 1e5, experiment.host_deadline);
  network.reject_unknown_keys();
}

// Every node of a test on several hosts is on one of them.
void check_hosts(const Config& file, const Experiment& experiment) {
  std::vector<std::string> known;
  for (const auto& host : experiment.hosts) known.push_back(host.name);
  for (const auto& plan : experiment.nodes) {
    const Config table = file.table("node").table(plan.node);
    if (plan.host.empty() && !known.empty())
      throw Error{fmt::format("{}: node '{}' has no host, expected host = one of {}", table.where(),
                              plan.node, fmt::join(known, ", "))};
    if (!plan.host.empty() && !contains(known, plan.host))
      table.fail("host",
                 fmt::format("host is '{}', expected {}", plan.host,
                             known.empty() ? "a table [host." + plan.host + "]"
                                           : fmt::format("one of {}", fmt::join(known, ", "))));
  }
  const auto has_address = [](const HostPlan& host) { return !host.address.empty(); };
  const auto count = std::count_if(experiment.hosts.begin(), experiment.hosts.end(), has_address);
  if (count != 0 && count != static_cast<long>(known.size()))
    file.fail("host", fmt::format("{} of {} hosts have an address, expected all or none", count,
                                  known.size()));
}

void read_uncompensated(const Config& table, Experiment& experiment) {
  for (const auto& node : table.keys()) {
    const auto plan = std::find_if(experiment.nodes.begin(), experiment.nodes.end(),
                                   [&](const auto& candidate) { return candidate.node == node; });
    if (plan == experiment.nodes.end())
      table.fail(
          node,
          fmt::format("[uncompensated] names node '{}', expected a node of the experiment", node));
    read_tuning(table.table(node), "", plan->uncompensated);
  }
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
  for (const auto& words : experiment.roles.axes)
    experiment.machine_axes.push_back(
        {words.axis, words.reference, words.machine_displacement, words.machine_force});
}

// The response of another structure would be no expected motion.
void check_targets(const Config& file, const Experiment& experiment) {
  const Config targets = file.table_or_empty("targets");
  if (targets.text("kind", "") != "response" || experiment.solves_plant()) return;
  targets.fail("kind",
               "kind is 'response', but the solver has a structure of its own, expected 'file'");
}

void read_reference(const Config& file, Experiment& experiment) {
  if (!file.has("reference")) return;
  const Config table = file.table("reference");
  experiment.reference = read_displacements(table);
  table.reject_unknown_keys();
}

void require_motion(const Config& file, const Experiment& experiment) {
  for (const auto& plan : experiment.nodes)
    if (!plan.settings.motion_fault.empty()) file.fail("held_out", plan.settings.motion_fault);
}

// Experiments with different seeds differ in all their noise.
void spread_seed(Experiment& experiment) {
  experiment.machine.seed = experiment.seed;
  experiment.machine.specimen = experiment.specimen;
  experiment.computing_time.seed = experiment.seed + 1;
}

// The time of machine and controller stands still together, or of none: a machine that is real, of
// another host or of another period moves on, and so do cards.
void settle_missed_steps(Experiment& experiment) {
  const Schedule* first = nullptr;
  bool all_wait = !experiment.cards.has_value();
  const auto is_part = [](const NodePlan& plan) {
    return plan.settings.role == Role::Machine || plan.settings.role == Role::Controller;
  };
  for (const auto& plan : experiment.nodes) {
    if (!is_part(plan)) continue;
    if (first == nullptr) first = &plan.schedule;
    all_wait = all_wait && plan.schedule.missed == MissedSteps::Wait &&
               plan.schedule.period == first->period && plan.host == experiment.nodes[0].host;
  }
  for (auto& plan : experiment.nodes)
    if (!all_wait && plan.schedule.missed == MissedSteps::Wait)
      plan.schedule.missed = MissedSteps::MakeDue;
}

}  // namespace

bool Experiment::has_own_solver() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const NodePlan& plan) {
    return plan.settings.role == Role::Solver && !plan.settings.program;
  });
}

bool Experiment::integrates_plant() const {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const NodePlan& plan) { return plan.settings.integrates_plant; });
}

const NodePlan* Experiment::repeatable_solver() const {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [](const NodePlan& plan) {
    return plan.settings.ideal_machine != nullptr;
  });
  return found == nodes.end() ? nullptr : &*found;
}

bool Experiment::solves_plant() const {
  return integrates_plant() || (has_plant && repeatable_solver() == nullptr);
}

sim::GroundMotion Experiment::tested_motion() const {
  sim::GroundMotion tested = motion;
  if (!contains(axes, "long"))
    std::fill(tested.long_acceleration.begin(), tested.long_acceleration.end(), 0);
  if (!contains(axes, "lat"))
    std::fill(tested.lat_acceleration.begin(), tested.lat_acceleration.end(), 0);
  return tested;
}

std::optional<double> Experiment::latest_end() const {
  constexpr double kMargin = 1;  // [s]
  const bool may_not_end = std::any_of(
      nodes.begin(), nodes.end(), [](const NodePlan& plan) { return plan.settings.may_not_end; });
  if (!may_not_end) return std::nullopt;
  return rest + 2 * duration * rate + kMargin;
}

bool Experiment::has_user_program() const {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const NodePlan& plan) { return plan.settings.program.has_value(); });
}

std::string Experiment::leading_host() const {
  for (const auto& plan : nodes)
    if (plan.settings.role == Role::Recorder) return plan.host;
  return hosts.empty() ? "" : hosts.front().name;
}

std::optional<std::string> Experiment::unguarded_machine() const {
  for (const auto& plan : nodes)
    if (plan.settings.lacks_safety &&
        (plan.settings.role == Role::Machine || plan.node == roles.machine))
      return plan.node;
  return std::nullopt;
}

recording::NamedTexts Experiment::texts() const {
  recording::NamedTexts all = config;
  for (const auto& plan : nodes) {
    if (!plan.settings.texts) continue;
    const auto own = plan.settings.texts();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

namespace {

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

}  // namespace

Config changed_experiment(const std::filesystem::path& file, const Overrides& overrides) {
  require_experiment(file);
  Config changed = Config::load(file);
  for (const auto& [key, value] : overrides) changed.set(key, value);
  return changed.in_its_folder();
}

Experiment load_experiment(Kinds kinds, const std::filesystem::path& path,
                           const Overrides& overrides) {
  const Config file = changed_experiment(path, overrides);
  refuse_case(file);
  const std::int64_t format = file.integer("format");
  if (format != kExperimentFormat)
    file.fail("format",
              fmt::format("format is {}, this program reads {}", format, kExperimentFormat));
  Experiment experiment;
  experiment.file = path;
  experiment.config = {{path.filename().string(), read_file(path, kMostTextBytes)}};
  experiment.name = read_name(file);
  experiment.map = find_file(file, "map", "maps");
  read_axes(file, experiment);
  read_steps(file, experiment);
  read_ground_motion(file, experiment);
  // As with `uncompensated`, an empty table is none.
  if (const Config held_out = file.table_or_empty("held_out"); !held_out.keys().empty()) {
    experiment.held_out = read_motion(held_out);
    add_remarks(check_motion(held_out, *experiment.held_out, experiment.axes), experiment);
  }
  experiment.plant = read_plant(file.table_or_empty("plant"));
  read_laboratory(file, experiment);
  if (file.has("targets"))
    experiment.history =
        read_targets(file.table("targets"), experiment, experiment.seed + kTargetSeed);
  read_solver(file.table_or_empty("solver"), experiment);
  read_stop(file.table_or_empty("stop"), experiment);
  experiment.nodes = read_nodes(kinds, file.table("node"), experiment);
  experiment.longest_stop = experiment.retreat.hold + experiment.retreat.ramp;
  for (const auto& plan : experiment.nodes)
    experiment.longest_stop = std::max(experiment.longest_stop, plan.settings.longest_stop);
  read_hosts(file, experiment);
  check_hosts(file, experiment);
  read_ring(file, experiment);
  read_uncompensated(file.table_or_empty("uncompensated"), experiment);
  experiment.conclusive = file.table_or_empty("conclusive");
  experiment.has_plant = file.has("plant");
  check_targets(file, experiment);
  read_reference(file, experiment);
  read_roles(file, experiment);
  if (experiment.held_out) require_motion(file, experiment);
  file.reject_unknown_keys();
  check_uses(file, experiment);
  spread_seed(experiment);
  settle_missed_steps(experiment);
  std::string changes;
  for (const auto& [key, value] : overrides) changes += fmt::format("{}={}\n", key, value);
  if (!changes.empty()) experiment.config.emplace_back(recording::kOverridesText, changes);
  return experiment;
}

}  // namespace rths::experiment

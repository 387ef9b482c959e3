// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include <rths/app/adapter_files.hpp>
#include <rths/app/builtin_adapters.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>
#include <rths/experiment/check.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/table.hpp>
#include <rths/replicated/scenario.hpp>
#include <rths/session/diagnose.hpp>
#include <rths/session/folder.hpp>
#include <rths/session/run.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/composition.hpp>
#include <rths/sim/isolated_plant.hpp>
#include <rths/sim/machine/platen_machine.hpp>
#include <rths/sim/motion_file.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

// "from 0 to 29.99 in steps of 0.01" for time, otherwise the range.
std::string range_of(const std::vector<double>& values) {
  double least = INFINITY, most = -INFINITY;
  for (const double value : values) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  std::string text = fmt::format("{:.5g} to {:.5g}", least, most);
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(std::abs(values[i] - values[0] - static_cast<double>(i) * step) < 0.02 * step))
      return text;
  return step > 0 ? fmt::format("{} in steps of {:.5g}", text, step) : text;
}

std::string describe_values(const recording::Table::Column& column) {
  const auto bad = std::count_if(column.values.begin(), column.values.end(),
                                 [](double value) { return std::isnan(value); });
  std::string text = fmt::format("'{}'", printable(column.name));
  if (!column.unit.empty()) text += fmt::format(" [{}]", printable(column.unit));
  if (!column.slice.empty()) text += fmt::format(", {}", printable(column.slice));
  text += fmt::format(": {} values", column.values.size());
  if (static_cast<std::size_t>(bad) == column.values.size()) return text + ", none is a number";
  text += ", " + range_of(column.values);
  return bad == 0 ? text : fmt::format("{}, {} without a number", text, bad);
}

std::string describe_column(const sim::MotionFile& motion, int column) {
  const auto& of = motion.columns[static_cast<std::size_t>(column - 1)];
  const bool is_acceleration =
      of.stated.unknown.empty() &&
      (of.stated.unit == nullptr || of.stated.unit->kind == sim::MotionUnit::Kind::Acceleration);
  std::string text = motion.has_one_component() ? "" : fmt::format(" of column {}", column);
  if (of.values.size() != motion.columns[0].values.size())
    text += fmt::format(" with {} samples", of.values.size());
  if (!of.heading.empty()) text += fmt::format(" '{}'", printable(of.heading.substr(0, 60)));
  if (!is_acceleration) return "no acceleration" + text;
  double peak = 0;
  for (const double value : sim::acceleration_in_g(motion, column))
    peak = std::max(peak, std::abs(value));
  const auto unit =
      of.stated.unit == nullptr ? "no unit, read as g" : fmt::format("in {}", of.stated.unit->name);
  return fmt::format("{:.4g} g{} ({})", peak, text, unit);
}

int check_motion(const std::string& file) {
  const auto [motion, remarks] = experiment::check_motion_file(file);
  std::string text = fmt::format("{}: ground motion ({}), {} samples, interval {:g} s, peak ", file,
                                 motion.format, motion.columns[0].values.size(), motion.time_step);
  for (std::size_t i = 0; i < motion.columns.size(); ++i)
    text += (i == 0 ? "" : ", ") + describe_column(motion, static_cast<int>(i) + 1);
  fmt::print("{}\n", text);
  for (const auto& remark : remarks) write_message(fmt::format("rths: {}: {}\n", file, remark));
  return kOk;
}

// Whether headings of a file name other quantities than those of the ground, such as a force.
bool is_log(const recording::Table& table) {
  bool has_other = false;
  for (const auto& column : table.columns()) {
    const auto stated = sim::stated_unit(
        column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit));
    if (stated.unit != nullptr && stated.unit->kind == sim::MotionUnit::Kind::Acceleration)
      return false;
    const bool is_time = &column == &table.columns().front();
    has_other = has_other ||
                (!is_time &&
                 (!stated.unknown.empty() ||
                  (stated.unit != nullptr && stated.unit->kind == sim::MotionUnit::Kind::Other)));
  }
  return has_other;
}

// The columns of a log; empty if the file is none.
std::optional<recording::Table> read_log(const std::string& file) {
  try {
    auto table = recording::Table::load(file);
    return is_log(table) ? std::optional{std::move(table)} : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

int describe_table(const std::string& file, const recording::Table& table) {
  fmt::print("{}: table of {} columns for the records of a case\n", file, table.columns().size());
  for (const auto& column : table.columns()) fmt::print("  {}\n", describe_values(column));
  return kOk;
}

int check_table(const std::string& file) {
  return describe_table(file, recording::Table::load(file));
}

// Prints format, time step, and the unit and peak of each column of a file of ground motion. A text
// file whose headings name other quantities is a table.
int check_columns(const std::string& file) {
  try {
    return check_motion(file);
  } catch (const Error&) {
    const auto log = read_log(file);
    if (!log) throw;
    return describe_table(file, *log);
  }
}

struct CheckArguments {
  std::string file;               ///< or "server"
  ServerArguments server;         ///< its address; empty: a file
  std::string config;             ///< file with the `config` of a plugin; empty: none
  std::vector<std::string> sets;  ///< key=value
  Changes changes;                ///< of an experiment
};

int print_line(const std::string& text) {
  fmt::print("{}\n", text);
  return kOk;
}

// One line per rule. Exit code 1 if a rule is broken.
int print_findings(const std::string& name, const Conformance& found) {
  using Outcome = adapters::Finding::Outcome;
  const auto& findings = found.findings;
  const auto count = [&](Outcome outcome) {
    return std::count_if(findings.begin(), findings.end(),
                         [&](const auto& finding) { return finding.outcome == outcome; });
  };
  for (const auto& [rule, outcome, text] : findings) {
    const char* word = outcome == Outcome::Pass ? "PASS" : "FAIL";
    if (outcome == Outcome::NotTried) word = "----";
    fmt::print("{}  {:<12} {}\n", word, rule, outcome == Outcome::NotTried ? "not tried" : text);
  }
  fmt::print("{}: {}, {} of {} rules passed, {} failed, {} not tried\n", name, found.kind,
             count(Outcome::Pass), findings.size(), count(Outcome::Fail), count(Outcome::NotTried));
  return count(Outcome::Fail) == 0 ? kOk : kConditionNotMet;
}

int check_recording(const std::string& file) {
  const bool repaired = recording::repair(file);
  const recording::Reader reader{file};
  std::int64_t dropped = 0;
  for (const auto& [node, count] : reader.drops()) dropped += count;
  fmt::print(
      "{}: recording, {} rows of {} signals, {:.3f} s, {} events, {} rows missing, {} steps not "
      "recorded{}\n",
      file, reader.rows(), reader.names().size(), reader.rows() > 0 ? reader.time().back() : 0.0,
      reader.events().size(), reader.rows_missing(), dropped,
      repaired ? "; was not closed by its writer, repaired" : "");
  return kOk;
}

int check_experiment(const std::string& file, const experiment::Overrides& changes) {
  const auto experiment = load_experiment(file, changes);
  session::check_setup(experiment);
  check_sizes(experiment);
  fmt::print("{}: experiment '{}', {} nodes, {:g} s of '{}'\n", file, experiment.name,
             experiment.nodes.size(), experiment.time.duration, experiment.earthquake.name);
  if (const auto summary = experiment.plant.structure->summary(); !summary.empty())
    fmt::print("{}\n", summary);
  if (!experiment.history) fmt::print("{}\n", experiment::describe_motion(experiment));
  return kOk;
}

int check_bearing(const std::string& file, const Config& config) {
  const double load = sim::weight_per_bearing(sim::example_plant());
  const auto bearing = sim::read_bearing(config, load);
  fmt::print("{}: bearing '{}', {} terms, initial stiffness {:.4g} MN/m under {:.2f} MN\n", file,
             bearing.title, bearing.terms.size(), sim::initial_stiffness(bearing) / 1e6,
             load / 1e6);
  return kOk;
}

int check_case(const std::string& file) {
  const auto c = session::checked_case(file);
  fmt::print("{}: case '{}', {} records, model of kind '{}'\n", file, c.name, c.records.size(),
             name_of(c.model.kind));
  for (const auto& record : c.records) {
    fmt::print("  '{}': {}, {} samples, interval {:.5g} s\n", printable(record.name),
               diagnosis::name_of(record.use), record.samples(), record.time_step);
    for (const auto& channel : record.channels)
      fmt::print("    {} [{}]: {}\n", channel.role, channel.unit, range_of(channel.values));
  }
  return kOk;
}

// An improved.toml is a part of a model: terms of the specimen and of the machine. A term with a
// kind is whole; others change terms of the experiment.
int check_improvement(const std::string& file, const Config& config) {
  std::size_t terms = 0;
  for (const auto& [side, owner] : {std::pair{"specimen", sim::TermOwner::Specimen},
                                    std::pair{"machine", sim::TermOwner::Machine}}) {
    const Config found = config.table_or_empty(side);
    for (const auto& name : found.keys()) {
      if (!found.is_table(name)) found.fail(name, name + " is not a term, expected a table");
      Config whole;
      whole.set(name, found.table(name));
      if (found.table(name).has("kind")) static_cast<void>(sim::read_terms(whole, owner));
      ++terms;
    }
  }
  config.reject_unknown_keys();
  fmt::print(
      "{}: improved model of a diagnosis, {} terms; apply it with 'rths run EXPERIMENT --improve "
      "{}'\n",
      file, terms, file);
  return kOk;
}

int check_machine(const std::string& file, const Config& config) {
  const auto machine = sim::machine::read_platen_machine(config);
  const auto frequencies = sim::machine::natural_frequencies(machine);
  fmt::print("{}: machine '{}', lowest natural frequency {:.3g} Hz on an empty table\n", file,
             machine.title, frequencies[0]);
  return kOk;
}

int check_scenario(const std::string& file) {
  const auto scenario = replicated::load_scenario(file);
  fmt::print("{}: scenario of {} cards, {:g} µs\n", file, scenario.names.size(),
             replicated::to_ns(scenario.duration) * 1e-3);
  return kOk;
}

bool has_value(const Config& config, const char* key) {
  return config.has(key) && !config.is_table(key);
}

// A scenario of cards has a list of nodes. A file with tables of nodes alone lacks its format.
bool is_experiment(const Config& config) {
  for (const char* other : {"ringmap", "diagram", "bearing", "record", "channels", "run"})
    if (config.has(other)) return false;
  return !has_value(config, "node") && (config.has("format") || config.has("node"));
}

int check_changed(const std::string& file, const experiment::Overrides& changes) {
  if (!is_experiment(Config::load(file)))
    throw Error{file + ": is no experiment, expected one with --set"};
  return check_experiment(file, changes);
}

int check_toml(const std::string& file) {
  const auto config = Config::load(file);
  if (config.has("ringmap")) return map_check(file);
  if (config.has("diagram")) return print_line(describe_diagram(file));
  if (config.has("bearing")) return check_bearing(file, config);
  if (config.has("record") || config.has("channels") || config.has("run")) return check_case(file);
  if (has_value(config, "node")) return check_scenario(file);
  if (is_experiment(config)) return check_experiment(file, {});
  if (has_value(config, "safety")) return print_line(describe_limits(file));
  if (has_value(config, "machine")) return check_machine(file, config);
  if (config.has("specimen") || config.has("machine")) return check_improvement(file, config);
  if (const auto text = describe_constants(file, config); !text.empty()) return print_line(text);
  throw Error{
      file +
      ": unknown kind of TOML file, expected one of the keys ringmap (map), diagram (block "
      "diagram), bearing, machine, safety (limits), record or run (case of a diagnosis), format "
      "(experiment; scenario of cards), specimen and machine (improved model), or tables of blocks "
      "(constants)"};
}

// The first line that is not blank, and if there is one, not a comment; it distinguishes the text
// formats.
std::string first_line(const std::string& content) {
  std::istringstream stream{content};
  std::string line, comment;
  while (std::getline(stream, line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (line[0] != '#') return line;
    comment = line;
  }
  return comment;
}

bool looks_like_toml(const std::string& line) {
  return line[0] == '[' || (line.find('=') != std::string::npos && line.find(',') > line.find('='));
}

int check(const CheckArguments& arguments) {
  const auto& file = arguments.file;
  if (!arguments.server.address.empty())
    return print_findings(arguments.server.address, check_server(file, arguments.server));
  if (!arguments.changes.empty()) return check_changed(file, arguments.changes);
  if (is_adapter(file)) {
    const Interruptible interruptible;
    return print_findings(file, check_adapter(file, arguments.config));
  }
  if (std::filesystem::is_directory(file))
    return check_recording(session::recording_in(file).string());
  check_is_file(file);
  if (recording::Table::is_format_of(file)) return check_table(file);
  if (recording::is_hdf5(file)) return check_recording(file);
  const std::string head = read_file(file, kMostTextBytes);
  const std::string line = first_line(head);
  if (line.empty()) throw Error{file + ": is empty"};
  if (sim::looks_like_motion(head)) return check_columns(file);
  if (looks_like_toml(line) || (line[0] == '#' && head.find("\n[") != std::string::npos))
    return check_toml(file);
  return check_columns(file);
}

}  // namespace

void add_check(CommandLine& line) {
  auto [command, a] =
      line.add("check",
               "Check a map, diagram, constants, bearing, machine, safety "
               "limits, experiment, scenario of cards, case, improved "
               "model, motion, recording, plugin or FMU; its content "
               "decides which",
               check, [](CheckArguments& given) { given.changes = split_changes(given.sets); });
  command->add_option("file", a.file, "File, or the word server")->required();
  command->add_option("address", a.server.address,
                      "HOST:PORT of a server for OpenSees' genericClient, after the word server");
  command->add_option("--config", a.config, "TOML file with the config of a plugin")
      ->check(CLI::ExistingFile);
  command->add_option("--dofs", a.server.dofs, "Degrees of freedom of a server")
      ->check(CLI::Range(1, 15))
      ->capture_default_str();
  command
      ->add_option("--amplitude", a.server.amplitude,
                   "Trial displacement of a server, in its units [0: it stays at rest]")
      ->check(not_negative());
  command->add_flag("--udp", a.server.udp, "The server uses UDP");
  repeatable(command->add_option("--set", a.sets,
                                 "Override a key of the experiment, as in rths run: key=value"));
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/session/folder.hpp>
#include <rths/session/plant.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct PlantArguments {
  std::string file;
  std::vector<std::string> sets;  ///< key=value
  Changes changes;
  int modes = 20;          ///< to show
  double duration_s = 10;  ///< of the motion to check
};

void split_sets(PlantArguments& given) { given.changes = split_changes(given.sets); }

int build(const PlantArguments& a) {
  fmt::print("{}", session::build_plant(load_experiment(a.file, a.changes)));
  return kOk;
}

int show(const PlantArguments& a) {
  fmt::print("{}", session::describe_plant(load_experiment(a.file, a.changes), a.modes));
  return kOk;
}

int check(const PlantArguments& a) {
  fmt::print("{}", session::check_plant(load_experiment(a.file, a.changes), a.duration_s));
  return kOk;
}

struct MotionArguments {
  std::string run;  ///< recording, or folder of a run
  int bearing = 1;
  double at_s = 0;
};

int motion(const MotionArguments& a) {
  fmt::print("{}", session::motion_of_bearing(session::recording_in(a.run), a.bearing));
  return kOk;
}

int field(const MotionArguments& a) {
  fmt::print("{}", session::displacement_field(session::recording_in(a.run), a.at_s));
  return kOk;
}

}  // namespace

void add_plant(CommandLine& line) {
  auto* group = line.app.add_subcommand("plant", "Work with the large plant of an experiment");
  group->require_subcommand(1);
  const auto add = [&](const char* name, const char* description,
                       int (*work)(const PlantArguments&)) {
    auto [command, a] = line.add_to(*group, name, description, work, split_sets);
    command->add_option("experiment", a.file, "Experiment file")->required();
    repeatable(command->add_option("--set", a.sets,
                                   "Override a key of the experiment, as in rths run: key=value"));
    return std::pair<CLI::App*, PlantArguments&>{command, a};
  };
  add("build", "Compute the modes that a test of this plant needs, and keep them", build);
  auto [shown, of_show] =
      add("show", "Print size, modes, masses that move in them, and loads of the bearings", show);
  shown->add_option("--modes", of_show.modes, "Modes to print")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  auto [checked, of_check] =
      add("check", "Compare the reduced plant with one of all degrees of freedom", check);
  checked->add_option("--duration-s", of_check.duration_s, "Length of the motion from its begin")
      ->check(CLI::Range(0.1, 1e4))
      ->capture_default_str();
  const auto add_result = [&](const char* name, const char* description,
                              int (*work)(const MotionArguments&)) {
    auto [command, a] = line.add_to(*group, name, description, work);
    command
        ->add_option("run", a.run,
                     "Recording of a test with record = [\"coordinates\"], or its folder")
        ->required()
        ->check(CLI::ExistingPath);
    return std::pair<CLI::App*, MotionArguments&>{command, a};
  };
  auto [moved, of_motion] =
      add_result("motion", "Print the displacement of a bearing in a run, as a table", motion);
  moved->add_option("--bearing", of_motion.bearing, "Its number, from 1, along lat first")
      ->required();
  auto [bent, of_field] = add_result(
      "field", "Print the displacements of all nodes at a time of a run, as a table", field);
  bent->add_option("--at-s", of_field.at_s, "Time of the target")->required();
}

}  // namespace rths::app

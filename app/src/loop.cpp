// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/command_line/drawing.hpp>
#include <rths/command_line/write_file.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>
#include <rths/sim/composition.hpp>
#include <rths/sim/isolated_plant.hpp>
#include <rths/sim/loop_test.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct LoopArguments {
  std::string bearing;     ///< file, or name of a built-in bearing
  double amplitude = 0.2;  ///< [m]
  double frequency = 0.3;  ///< [Hz]
  int cycles = 3;          ///< at full amplitude
  double axial_load = 0;   ///< [N]; 0: weight per bearing of the example plant
  std::string svg, csv;    ///< files to write; empty: none
  Changes changes;
  std::vector<std::string> sets;  ///< key=value
};

using sim::LoopHistory;

Panel loop_panel(const std::string& title, const LoopHistory& history, bool both_axes) {
  Panel panel{title, "displacement [mm]", "force [kN]", {}};
  panel.curves.push_back({both_axes ? name_of(Axis::Long) : "",
                          scaled(history.displacement_long, 1e3),
                          scaled(history.force_long, 1e-3)});
  if (both_axes)
    panel.curves.push_back({name_of(Axis::Lat), scaled(history.displacement_lat, 1e3),
                            scaled(history.force_lat, 1e-3)});
  return panel;
}

std::string table_of(const std::vector<sim::CycleNumbers>& cycles) {
  std::string table = "cycle   peak kN   strength kN   stiffness kN/m   energy kJ\n";
  for (std::size_t i = 0; i < cycles.size(); ++i)
    table += fmt::format("{:5}{:10.0f}{:14.0f}{:17.0f}{:12.1f}\n", i + 1,
                         cycles[i].peak_force / 1e3, cycles[i].strength / 1e3,
                         cycles[i].effective_stiffness / 1e3, cycles[i].energy / 1e3);
  return table;
}

std::string csv_of(const LoopHistory& h) {
  std::string csv =
      "time_s,displacement_long_m,displacement_lat_m,force_long_N,force_lat_N,axial_load_N\n";
  for (std::size_t i = 0; i < h.time.size(); ++i)
    csv += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", h.time[i],
                       h.displacement_long[i], h.displacement_lat[i], h.force_long[i],
                       h.force_lat[i], h.axial_load[i]);
  return csv;
}

// A change names a term of the bearing and one of its parameters, or adds a term by its kind.
void check_change(const Config& bearing, const LoopArguments& arguments, const std::string& key) {
  const auto dot = key.find('.');
  if (dot == std::string::npos) return;
  const std::string term = key.substr(0, dot), parameter = key.substr(dot + 1);
  const auto& changes = arguments.changes;
  if (std::any_of(changes.begin(), changes.end(),
                  [&](const auto& change) { return change.first == term + ".kind"; }))
    return;
  if (!bearing.is_table(term)) {
    std::vector<std::string> terms = bearing.keys();
    std::erase_if(terms, [&](const std::string& name) { return !bearing.is_table(name); });
    throw Error{fmt::format("--set {}: bearing '{}' has no term '{}'{}", key, arguments.bearing,
                            term, did_you_mean_one_of(term, terms))};
  }
  std::vector<std::string> known;
  for (const auto& one : sim::term_kind(bearing.table(term).text("kind", term)).parameters)
    known.push_back(sim::parameter_key(one, sim::SensorChannel::Force));
  known.insert(known.end(), {"enabled", "axes"});
  if (!contains(known, parameter))
    throw Error{fmt::format("--set {}: term '{}' has no parameter '{}'{}", key, term, parameter,
                            did_you_mean_one_of(parameter, known))};
}

int loop(const LoopArguments& arguments) {
  const auto file = rths::find_bearing(arguments.bearing);
  Config table = Config::load(file);
  for (const auto& [key, value] : arguments.changes) check_change(table, arguments, key);
  for (const auto& [key, value] : arguments.changes) table.set(key, value);
  const double load = arguments.axial_load > 0 ? arguments.axial_load
                                               : sim::weight_per_bearing(sim::example_plant());
  const sim::Bearing bearing = sim::read_bearing(table, load);

  sim::LoopTest test;
  test.amplitude_long = arguments.amplitude;
  test.frequency = arguments.frequency;
  test.time_step = sim::time_step_of(test.frequency);
  test.cycles = arguments.cycles + 1;
  const LoopHistory line = sim::run_loop_test(bearing, test);
  sim::LoopTest eight = test;
  eight.amplitude_lat = 0.5 * arguments.amplitude;
  const LoopHistory orbit = sim::run_loop_test(bearing, eight);

  fmt::print("{}, {:.2f} MN, {:g} mm at {:g} Hz along one axis\n{}", bearing.title, load / 1e6,
             test.amplitude_long * 1e3, test.frequency, table_of(sim::cycle_numbers(line, test)));
  if (!arguments.csv.empty()) write_file(arguments.csv, csv_of(line));
  if (!arguments.svg.empty())
    write_file(arguments.svg, draw(fmt::format("{}, {:.2f} MN, {:g} Hz (model)", bearing.title,
                                               load / 1e6, test.frequency),
                                   {loop_panel("along one axis", line, false),
                                    loop_panel("along a figure of eight", orbit, true)}));
  return kOk;
}

}  // namespace

void add_loop(CommandLine& line) {
  auto [command, a] =
      line.add("loop", "Drive a bearing through loops; print and draw them", loop,
               [](LoopArguments& given) { given.changes = split_changes(given.sets); });
  command->add_option("bearing", a.bearing, "Built-in name (lprb, eqsb, tpfb) or file")->required();
  command->add_option("--amplitude-m", a.amplitude)
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str();
  command->add_option("--frequency-Hz", a.frequency)
      ->check(CLI::Range(1e-4, 20.0))
      ->capture_default_str();
  command
      ->add_option("--cycles", a.cycles,
                   "Cycles at full amplitude, after one with growing amplitude")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--axial-load-N", a.axial_load, "[weight per bearing of the example plant]")
      ->check(CLI::Range(0.0, 1e9));
  command->add_option("--svg", a.svg, "Draw both loops into this SVG file");
  command->add_option("--csv", a.csv, "Write the loop along one axis to this CSV file");
  repeatable(
      command->add_option("--set", a.sets, "Override a term: term.key=value, term.enabled=false"));
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/command_line/write_file.hpp>
#include <rths/core/text.hpp>
#include <rths/report/comparison.hpp>
#include <rths/session/folder.hpp>
#include <rths/session/why.hpp>

#include "command.hpp"
#include "figures.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

struct CompareArguments {
  std::string baseline, other;     ///< recordings, folders of runs, or tables
  std::vector<std::string> pairs;  ///< BASELINE=OTHER
  report::ComparisonSettings settings;
  std::optional<double> absolute, relative, time_s;
  std::size_t most = 20;  ///< signals to list
  bool is_json = false;
  bool asks_why = false;
  std::optional<std::string> page;  ///< HTML file
  FiguresArguments figures;
};

void complete(CompareArguments& a) {
  for (const auto& pair : a.pairs) {
    const auto names = key_value(pair);
    if (!names || names->second.empty())
      throw CLI::ValidationError{"--pair", "found '" + pair + "', expected BASELINE=OTHER"};
    a.settings.pairs.push_back(*names);
  }
  if (a.absolute || a.relative || a.time_s)
    a.settings.tolerance =
        report::Tolerance{a.absolute.value_or(0), a.relative.value_or(0), a.time_s.value_or(0)};
}

session::Difference difference_of(const report::ComparedRuns& found) {
  ShownProgress progress;
  auto difference = session::why(found, 1, progress.functions());
  progress.end();
  return difference;
}

int compare(const CompareArguments& a) {
  if (a.page) check_result_file(*a.page);
  a.figures.check();
  const auto found = report::compare(session::recording_in(a.baseline),
                                     session::recording_in(a.other), a.settings);
  if (!a.is_json) fmt::print("{}", report::text_of(found, a.most));
  std::fflush(stdout);
  std::string why;
  if (a.asks_why) {
    const auto difference = difference_of(found);
    why = session::json_of(difference);
    if (!a.is_json) fmt::print("{}", session::text_of(difference));
  }
  if (a.is_json) fmt::print("{}", report::json_of(found, why));
  if (a.page) {
    write_file(*a.page, report::comparison_page(found, a.most, why));
    if (!a.is_json) fmt::print("page {}\n", *a.page);
    std::fflush(stdout);
    const std::string figures = a.figures.write(*a.page);
    if (!a.is_json) fmt::print("{}", figures);
  }
  return found.broken() == 0 ? kOk : kConditionNotMet;
}

}  // namespace

void add_compare(CommandLine& line) {
  auto [command, a] =
      line.add("compare",
               "Compare two runs, recordings or tables, signal by signal; exit code 1 "
               "if one is outside its tolerance",
               compare, complete);
  command->add_option("baseline", a.baseline, "Recording, folder of a run, or table")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("other", a.other, "The same")->required()->check(CLI::ExistingPath);
  command->add_option("--signals", a.settings.patterns,
                      "Signal names; * and ? as in a shell [all that both have]");
  repeatable(command->add_option("--pair", a.pairs, "Signals of different names: BASELINE=OTHER"));
  command->add_option("--abs", a.absolute, "Tolerance: difference, in SI units")
      ->check(not_negative());
  command->add_option("--rel", a.relative, "Tolerance: share of the baseline's magnitude")
      ->check(not_negative());
  command->add_option("--time-s", a.time_s, "Tolerance: the baseline this much earlier or later")
      ->check(not_negative());
  command->add_option("--align", a.settings.aligned,
                      "Signal of the baseline whose delay is removed first");
  command->add_option("--search-s", a.settings.search, "Largest delay that is looked for")
      ->check(CLI::Range(1e-4, 1e3))
      ->capture_default_str();
  command->add_option("--from", a.settings.from, "First time of the baseline [s]");
  command->add_option("--to", a.settings.to, "Last time of the baseline [s]");
  auto* page = command->add_option(
      "--page", a.page, "Also write a page: settings, figures, curves and their difference");
  add_figures(*command, a.figures)->needs(page);
  command->add_option("--most", a.most, "Signals to list and to draw")->capture_default_str();
  command->add_flag("--why", a.asks_why,
                    "Also say why they differ: a mistake of signals, or a diagnosis of the other "
                    "with the simulation of the baseline");
  command->add_flag("--json", a.is_json, "One JSON document instead of lines");
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/command_line/drawing.hpp>
#include <rths/command_line/write_file.hpp>
#include <rths/sim/loop_test.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct TermsArguments {
  std::vector<std::string> names;  ///< empty: all
  std::string format = "text";     ///< text, markdown, or json, one object per line
  std::string draw;                ///< folder for drawings; empty: print text
};

using sim::LoopHistory;
using sim::TermKind;
using Values = std::vector<double> LoopHistory::*;

// One choice of axes for a drawing: an output over its input.
struct View {
  Values x, y;
  double x_scale, y_scale;
  const char *x_label, *y_label;
};
constexpr View kViews[] = {
    {&LoopHistory::displacement_long, &LoopHistory::force_long, 1e3, 1e-3, "displacement [mm]",
     "force [kN]"},
    {&LoopHistory::vertical_displacement, &LoopHistory::axial_load, 1e3, 1e-3,
     "vertical displacement [mm]", "axial load [kN]"},
    {&LoopHistory::time, &LoopHistory::acceleration_long, 1, 1, "time [s]", "acceleration [m/s²]"}};
constexpr View kCommandView = {
    &LoopHistory::command_long, &LoopHistory::displacement_long, 1e3, 1e3, "command [mm]",
    "displacement [mm]"};

double change(const std::vector<double>& without, const std::vector<double>& with) {
  double difference = 0, size = 1e-300;
  for (std::size_t i = 0; i < without.size(); ++i) {
    difference += std::pow(with[i] - without[i], 2);
    size += std::pow(without[i], 2) + std::pow(with[i], 2);
  }
  return difference / size;
}

// The view in which the term changes most; for an actuator, displacement over command.
const View& best_view(const TermKind& kind, const sim::Demonstration& shown) {
  const auto changed = [&](const View& view) {
    return change(shown.without.*view.y, shown.with.*view.y);
  };
  if (kind.stage == sim::Stage::Actuator) return kCommandView;
  return *std::max_element(std::begin(kViews), std::end(kViews),
                           [&](const View& a, const View& b) { return changed(a) < changed(b); });
}

// Draws the response with and without the term, and their difference, which can be too small to
// see in the first panel.
std::string drawing_of(const TermKind& kind) {
  const sim::Demonstration shown = sim::demonstrate(kind);
  const View& view = best_view(kind, shown);
  const auto x = scaled(shown.with.*view.x, view.x_scale);
  const auto with = scaled(shown.with.*view.y, view.y_scale);
  Panel panel{std::string{kind.name}, view.x_label, view.y_label, {}};
  std::vector<Panel> panels;
  if (shown.alone) {
    panel.curves.push_back({"", x, with});
    panels = {panel};
  } else {
    const auto without = scaled(shown.without.*view.y, view.y_scale);
    std::vector<double> difference(with.size());
    std::transform(with.begin(), with.end(), without.begin(), difference.begin(), std::minus{});
    panel.curves.push_back({"without", scaled(shown.without.*view.x, view.x_scale), without, true});
    panel.curves.push_back({"with", x, with});
    panels = {panel, {"difference", view.x_label, view.y_label, {{"", x, difference}}}};
  }
  return draw(fmt::format("{} (model)", kind.title), panels);
}

std::string parameter_rows(const TermKind& kind, const char* row) {
  std::string rows;
  for (const auto& p : kind.parameters)
    rows += fmt::format(fmt::runtime(row), sim::parameter_key(p, sim::SensorChannel::Force), p.low,
                        p.high, p.absent, p.typical);
  return rows;
}

std::string text_of(const TermKind& kind) {
  return fmt::format("{} ({}): {}\n    {}\n    source: {}\n{}", kind.name,
                     sim::stage_name(kind.stage), kind.title, kind.equation, kind.source,
                     parameter_rows(kind, "    {:<36} {:g} to {:g}, default {:g}, typical {:g}\n"));
}

std::string markdown_of(const TermKind& kind) {
  return fmt::format(
      "### {0}\n\n{1}. Stage: {2}. Source: {3}.\n\n    {4}\n\n"
      "| key | from | to | default | typical |\n|---|---|---|---|---|\n{5}\n"
      "![{1}](images/terms/{0}.svg)\n\n",
      kind.name, kind.title, sim::stage_name(kind.stage), kind.source, kind.equation,
      parameter_rows(kind, "| `{}` | {:g} | {:g} | {:g} | {:g} |\n"));
}

std::string json_of(const TermKind& kind) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  for (const auto& p : kind.parameters)
    parameters.push_back({{"key", sim::parameter_key(p, sim::SensorChannel::Force)},
                          {"low", p.low},
                          {"high", p.high},
                          {"default", p.absent},
                          {"typical", p.typical}});
  const nlohmann::ordered_json json = {
      {"term", kind.name},         {"title", kind.title},   {"stage", sim::stage_name(kind.stage)},
      {"equation", kind.equation}, {"source", kind.source}, {"parameters", parameters}};
  return json.dump() + "\n";
}

int terms(const TermsArguments& arguments) {
  std::vector<TermKind> kinds;
  for (const auto& name : arguments.names) kinds.push_back(sim::term_kind(name));
  if (kinds.empty()) kinds.assign(sim::catalogue().begin(), sim::catalogue().end());
  if (!arguments.draw.empty()) {
    std::filesystem::create_directories(arguments.draw);
    for (const auto& kind : kinds)
      write_file(std::filesystem::path{arguments.draw} / fmt::format("{}.svg", kind.name),
                 drawing_of(kind));
    return kOk;
  }
  for (const auto& kind : kinds)
    fmt::print("{}", arguments.format == "json"       ? json_of(kind)
                     : arguments.format == "markdown" ? markdown_of(kind)
                                                      : text_of(kind));
  return kOk;
}

}  // namespace

void add_terms(CommandLine& line) {
  auto [command, a] =
      line.add("terms", "List the terms of bearings, machines and sensors, with equations", terms);
  command->add_option("names", a.names, "Terms to list [all]");
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "markdown", "json"}));
  command->add_option("--draw", a.draw,
                      "Draw the effect of each term into this folder, print nothing");
}

}  // namespace rths::app

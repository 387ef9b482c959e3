// SPDX-License-Identifier: Apache-2.0
#include "opensees_run.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace rths {

Rows read_rows(const std::filesystem::path& file) {
  Rows rows;
  std::ifstream in{file};
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells{line};
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

double nrmse(const Rows& ours, const Rows& reference, std::size_t column) {
  double mean = 0, difference = 0, size = 0;
  for (const auto& row : reference) mean += row[column] / static_cast<double>(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    difference += std::pow(ours.at(i)[column] - reference[i][column], 2);
    size += std::pow(reference[i][column] - mean, 2);
  }
  return std::sqrt(difference / size);
}

std::string OpenSeesRun::experiment(const ExperimentOptions& options, double step) const {
  folder_.write("bilinear.toml",
                "bearing = 1\ntitle = \"bilinear\"\n[bilinear]\n"
                "characteristic_strength_N = 1_010_000\npost_yield_stiffness_N_per_m = 4_238_000\n"
                "yield_displacement_m = 2.855e-3\n");
  const auto tree = test::source_tree();
  const std::string script =
      options.script.empty()
          ? ""
          : fmt::format("python = \"{}\"\nscript = \"{}\"\narguments = [{}]\n", python_,
                        (tree / options.script).string(), options.arguments);
  const std::string element = options.element.empty() ? "dofs = " + options.axes : options.element;
  return folder_
      .write("experiment.toml",
             fmt::format(R"(format = 1
name = "opensees_test"
map = "{}"
axes = {}
duration_s = {}
integration_step_s = {}
[motion]
file = "{}"
column_long = 2
column_lat = 1
scale = 1.4
[specimen]
model = "bilinear.toml"
[conclusive]
response = 10
{}
[node.opf]
adapter = "opensees"
{}answer_deadline_s = 1
{}
[[node.opf.element]]
name = "bearing"
port = {}
{}
)",
                         options.map, options.map == "srmd" ? options.axes : kBoth, duration_, step,
                         (tree / "examples/records" / kRecord).string(), options.partners, script,
                         options.node, port_, element))
      .string();
}

test::Finished OpenSeesRun::run(const std::string& experiment, const std::string& clock) const {
  return test::run_rths({"run", experiment, "--clock", clock, "--out", out().string(), "--force"},
                        60);
}

Rows OpenSeesRun::own_response(const std::string& bearing) const {
  const auto response = folder_.path() / "own.csv";
  test::Running running{{python_, (test::source_tree() / kPlant).string(),
                         (test::source_tree() / "examples/records" / kRecord).string(), "--columns",
                         "2", "1", "--unit", "13.72931", "--bearing", bearing, "--duration",
                         std::to_string(duration_), "--response", response.string()}};
  EXPECT_EQ(running.wait(60).exit_code, 0);
  return read_rows(response);
}

std::string OpenSeesRun::plant_arguments() const {
  return fmt::format(
      R"("{{motion}}", "--port", "{}", "--duration", "{}", "--response", "{{results}}.csv")", port_,
      duration_);
}

}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
#include "contrary_runs.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>

namespace rths::launch {
namespace {

constexpr int kRows = 1000;     // of the records
constexpr double kStep = 0.01;  // [s]

/// Columns: time, a burst of 1 Hz, two thirds of it.
std::string record(double amplitude, const std::function<double(int row)>& time,
                   const std::string& heading = "") {
  std::string text = heading;
  for (int i = 0; i <= kRows; ++i) {
    const double value = amplitude * std::sin(std::numbers::pi * i / kRows) *
                         std::sin(2 * std::numbers::pi * i * kStep);
    text += fmt::format("{:.4f},{:.6f},{:.6f}\n", time(i), value, value * 2 / 3);
  }
  return text;
}

/// An experiment with these tables of nodes, beside the recorder.
std::string experiment(double duration, const std::string& nodes) {
  return fmt::format(R"(format = 1
name = "contrary"
map = "srmd"
axes = ["long"]
duration_s = {:g}
[motion]
file = "petrolia_1992_riodell_freefield"
{}[node.recorder]
adapter = "recorder"
)",
                     duration, nodes);
}

constexpr const char* kSolver = R"([node.xpc]
adapter = "ideal_machine"
[node.opf]
adapter = "plugin"
role = "solver"
library = "{library}"
config.duration_s = 3
config.fault = "none"
)";

constexpr const char* kMachine = R"([node.srmd]
adapter = "plugin"
role = "machine"
library = "{library}"
[node.xpc]
adapter = "simulink_like"
diagram = "hybrid_controller"
[node.opf]
adapter = "numerical"
)";

constexpr const char* kIdeal = R"([node.xpc]
adapter = "ideal_machine"
[node.opf]
adapter = "numerical"
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// With a plugin in place of "{library}".
std::string experiment_with(const std::string& name, const char* nodes) {
  constexpr double kDuration = 3;  // [s]
  return replaced(experiment(kDuration, nodes), "{library}",
                  (test::build_tree() / "broken" / name).string());
}

}  // namespace

ContraryRuns::ContraryRuns() : ring_{folder_.path().filename().string()} {
  write_records();
  write_experiments();
}

void ContraryRuns::write_records() const {
  const auto steady = [](int row) { return row * kStep; };
  const auto add = [&](const std::string& name, const std::string& text) {
    static_cast<void>(folder_.write(name, text));
  };
  add("g.csv", record(0.3, steady));
  add("slow.csv", record(0.2, [](int row) { return 2 * row * kStep; }));
  add("back.csv", record(0.3, [](int row) { return row * kStep - (row < 500 ? 0 : 2); }));
  add("repeated.csv", record(0.3, [](int row) { return (row - (row < 500 ? 0 : 1)) * kStep; }));
  add("uneven.csv", record(0.3, [](int row) { return (row + 0.3 * (row % 2)) * kStep; }));
  add("degrees.csv", record(0.3, steady, "time [s],h1 [deg],h2 [deg]\n"));
  add("mm_per_s2.csv", record(0.3 * 9806.65, steady));
  add("m.csv", record(0.05, steady));
  add("cm.csv", record(5, steady));
  add("inch.csv", record(0.05 * 39.37, steady));
  add("fast.csv", record(0.1, [](int row) { return 0.1 * row * kStep; }));
}

void ContraryRuns::write_experiments() const {
  const auto add = [&](const std::string& name, const std::string& text) {
    static_cast<void>(folder_.write(name, text));
  };
  add("solver.toml", experiment_with("contrary_solver.so", kSolver));
  add("controlled.toml",
      replaced(experiment_with("contrary_solver.so", kSolver), "adapter = \"ideal_machine\"",
               "adapter = \"simulink_like\"\ndiagram = \"hybrid_controller\"\n[node.srmd]\n"
               "adapter = \"srmd\""));
  add("machine.toml", experiment_with("correct.so", kMachine));
  add("ideal.toml", experiment(1.5, kIdeal));
}

std::vector<std::string> ContraryRuns::command(const std::string& experiment,
                                               const std::vector<std::string>& sets,
                                               const std::string& clock) const {
  const auto own = folder_.path() / (experiment + ".toml");
  const bool is_own = std::filesystem::exists(own);
  const auto example = test::source_tree() / "examples" / (experiment + ".toml");
  std::vector<std::string> words{
      "run",   (is_own ? own : example).string(), "--clock", clock, "--no-diagnosis",
      "--out", (folder_.path() / "out").string(), "--ring",  ring_};
  const auto set = [&](const std::string& change) {
    words.insert(words.end(), {"--set", replaced(change, "{files}", folder_.path().string())});
  };
  if (!is_own)
    for (const char* change : {"duration_s=6", "uncompensated={}", "held_out={}"}) set(change);
  for (const auto& change : sets) set(change);
  return words;
}

test::Finished ContraryRuns::run(const std::string& experiment,
                                 const std::vector<std::string>& sets,
                                 const std::string& clock) const {
  return test::run_rths(command(experiment, sets, clock), 60);
}

}  // namespace rths::launch

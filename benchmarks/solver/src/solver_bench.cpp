// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/solver_bench.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/plant/large_plant.hpp>

#include "opensees_steps.hpp"

namespace rths::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTimeSteps[] = {0.01, 0.001};  // [s]
constexpr double kShareOfStep = 0.6;            // of the time step: the paper's 6 ms of 10
constexpr long kMostOfFull = 15'000;            // degrees of freedom
constexpr int kFewerOfOpenSees = 20;            // steps of a larger plant: one in so many
constexpr const char* kOpenSeesSettings = "Mumps, AlphaOS, Linear -initial -factorOnce";
constexpr int kWarmUp = 50;  // steps that do not count

sim::Bearing bearing_of(double mean_weight) {
  const auto file = shared_files() / "bearings/lprb.toml";
  return sim::read_bearing(Config::load(file), mean_weight);
}

sim::GroundMotion motion() {
  const auto file = shared_files() / "examples/records/petrolia_1992_riodell_freefield.csv";
  return sim::read_motion(file, {2, 1, 3}, 1);
}

long times_put_aside() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

double memory_of_process() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

bool is_ours(const SolverRow& row) { return row.path != "opensees"; }

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// Times of the steps of one analysis whose specimen is computed, too.
class Steps {
 public:
  Steps(sim::Substructure& analysis, const sim::Bearing& bearing, double time_step)
      : analysis_{analysis}, specimen_{bearing, time_step}, load_{bearing.axial_load} {}

  void run(int count) {
    analysis_.predict(target_, rate_);
    for (int i = 0; i < count + kWarmUp; ++i) step(i >= kWarmUp);
  }
  void fill(SolverRow& row, double limit) {
    if (whole_.empty())
      throw Error{"other processes interrupted every step: measure again on a quieter machine"};
    row.steps = static_cast<int>(whole_.size()) + excused_;
    row.excused = excused_;
    row.misses = static_cast<int>(
        std::count_if(whole_.begin(), whole_.end(), [&](double time) { return time > limit; }));
    row.median = maths::quantile(whole_, 0.5);
    row.p99 = maths::quantile(whole_, 0.99);
    row.p999 = maths::quantile(whole_, 0.999);
    row.largest = maths::quantile(whole_, 1);
    row.critical_median = maths::quantile(critical_, 0.5);
    row.critical_p99 = maths::quantile(critical_, 0.99);
  }

 private:
  // From target to target: first what runs while the machine moves, then what waits for its force.
  void step(bool counts) {
    const long before = times_put_aside();
    const auto begun = Clock::now();
    analysis_.work_ahead();
    const auto worked = Clock::now();
    const Eigen::Vector2d felt =
        specimen_.advance({target_[0], target_[1]}, {rate_[0], rate_[1]}, load_ + target_[2]);
    const std::array<double, 3> force{felt[0], felt[1], 0};
    const auto known = Clock::now();
    analysis_.correct(force);
    analysis_.predict(target_, rate_);
    const auto ended = Clock::now();
    if (!counts) return;
    if (times_put_aside() != before) {
      ++excused_;
      return;
    }
    whole_.push_back(seconds(worked - begun + (ended - known)));
    critical_.push_back(seconds(ended - known));
  }

  sim::Substructure& analysis_;
  sim::BearingRun specimen_;
  double load_;
  std::array<double, 3> target_{}, rate_{};
  std::vector<double> whole_, critical_;
  int excused_ = 0;
};

SolverRow measured(const plant::LargePlant& model, double time_step, int steps) {
  const auto& description = model.description();
  SolverRow row;
  row.dof = static_cast<long>(model.basis().dofs);
  row.bearings = description.bearings.kind_of.size();
  row.time_step = time_step;
  row.path = description.is_full ? "full" : "reduced";
  row.coordinates = description.is_full ? 0 : static_cast<int>(model.basis().coordinates());
  const auto analysis = model.analysis({motion(), 0, time_step});
  sim::Bearing specimen = description.bearings.kinds[0];
  specimen.axial_load = model.weight();
  Steps measurement{*analysis, specimen, time_step};
  measurement.run(steps);
  measurement.fill(row, kShareOfStep * time_step);
  row.dofs_per_us = static_cast<double>(row.dof) / (1e6 * row.median);
  row.memory = memory_of_process();
  return row;
}

SolverRow row_of(const OpenSeesSteps& theirs, long dofs, double time_step) {
  SolverRow row;
  row.dof = dofs;
  row.bearings = plant::kAntBearings;
  row.time_step = time_step;
  row.path = "opensees";
  row.steps = static_cast<int>(theirs.wall.size());
  row.misses =
      static_cast<int>(std::count_if(theirs.wall.begin(), theirs.wall.end(),
                                     [&](double time) { return time > kShareOfStep * time_step; }));
  row.median = maths::quantile(theirs.wall, 0.5);
  row.p99 = maths::quantile(theirs.wall, 0.99);
  row.p999 = maths::quantile(theirs.wall, 0.999);
  row.largest = maths::quantile(theirs.wall, 1);
  row.processor_median = maths::quantile(theirs.processor, 0.5);
  row.dofs_per_us = static_cast<double>(row.dof) / (1e6 * row.median);
  row.memory = theirs.memory;
  return row;
}

// Beside the rows of one plant, in the same run: OpenSees has the same time for any time step.
void add_opensees(const SolverOptions& options, const plant::AntDesign& design,
                  const plant::PlantDescription& description, std::size_t first,
                  SolverReport& report) {
  const double time_step = kTimeSteps[0];
  const long dofs = report.rows[first].dof;
  const int steps = options.opensees_steps / (dofs > kMostOfFull ? kFewerOfOpenSees : 1);
  const auto theirs = opensees_steps({options.python, options.script}, design, description,
                                     motion(), time_step, std::max(1, steps));
  report.has_opensees = theirs.missing.empty();
  report.opensees = report.has_opensees ? theirs.version : theirs.missing;
  if (!report.has_opensees) return;
  const SolverRow row = row_of(theirs, dofs, time_step);
  for (std::size_t i = first; i < report.rows.size(); ++i)
    report.rows[i].ratio_to_opensees = row.processor_median / report.rows[i].median;
  report.rows.push_back(row);
}

}  // namespace

SolverReport run_solver_bench(const SolverOptions& options) {
  SolverReport report;
  report.machine = describe_machine();
  for (const long dofs : options.dofs) {
    const auto design = plant::ant_with(dofs);
    const auto bearing = bearing_of(design.mass() * kStandardGravity / plant::kAntBearings);
    const std::size_t first = report.rows.size();
    for (const bool is_full : {false, true}) {
      if (is_full && dofs > kMostOfFull) continue;
      if (options.progress)
        options.progress(
            fmt::format("{} degrees of freedom, {}", dofs, is_full ? "full" : "reduced"));
      auto description = plant::describe(design, bearing);
      description.is_full = is_full;
      const plant::LargePlant model{std::move(description), plant::cache_folder()};
      for (const double time_step : kTimeSteps)
        report.rows.push_back(
            measured(model, time_step, is_full ? options.steps / 10 : options.steps));
    }
    if (options.progress) options.progress(fmt::format("{} degrees of freedom, OpenSees", dofs));
    add_opensees(options, design, plant::describe(design, bearing), first, report);
  }
  return report;
}

namespace {

nlohmann::ordered_json document(const SolverRow& row) {
  nlohmann::ordered_json json{
      {"name", fmt::format("{}_{}_{:g}ms", row.path, row.dof, 1e3 * row.time_step)},
      {"dof", row.dof},
      {"bearings", row.bearings},
      {"step_ms", 1e3 * row.time_step},
      {"path", row.path},
      {"coordinates", row.coordinates},
      {"p50_ms", 1e3 * row.median},
      {"p99_ms", 1e3 * row.p99},
      {"p999_ms", 1e3 * row.p999},
      {"max_ms", 1e3 * row.largest}};
  if (is_ours(row)) {
    json["critical_p50_us"] = 1e6 * row.critical_median;
    json["critical_p99_us"] = 1e6 * row.critical_p99;
  } else {
    json["processor_p50_ms"] = 1e3 * row.processor_median;
  }
  json["steps"] = row.steps;
  json["excused"] = row.excused;
  json["misses"] = row.misses;
  json["dof_per_us"] = row.dofs_per_us;
  json["memory_MB"] = 1e-6 * row.memory;
  if (row.ratio_to_opensees > 0) json["ratio_to_opensees"] = row.ratio_to_opensees;
  return json;
}

std::string line_of(const SolverRow& row) {
  std::string line =
      fmt::format("{:>7}  {:<8} {:>2.0f} ms  {:>8.3f} ms {:>8.3f} ms {:>8.3f} ms", row.dof,
                  row.path, 1e3 * row.time_step, 1e3 * row.median, 1e3 * row.p99, 1e3 * row.p999);
  line += is_ours(row) ? fmt::format("  {:>5.2f} us, {:>6.2f} us", 1e6 * row.critical_median,
                                     1e6 * row.critical_p99)
                       : fmt::format("  {:>7.3f} ms of processor", 1e3 * row.processor_median);
  line += fmt::format(" {:>6}  {:>4} of {}", row.misses, row.excused, row.steps);
  if (row.ratio_to_opensees > 0) line += fmt::format("  {:.0f}", row.ratio_to_opensees);
  return line + "\n";
}

}  // namespace

std::string to_json(const SolverReport& report) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : report.rows) rows.push_back(document(row));
  nlohmann::ordered_json opensees;
  opensees[report.has_opensees ? "version" : "missing"] = report.opensees;
  if (report.has_opensees) opensees["settings"] = kOpenSeesSettings;
  return nlohmann::ordered_json{{"machine",
                                 {{"cpu", report.machine.cpu},
                                  {"cpus", report.machine.processors},
                                  {"kernel", report.machine.kernel}}},
                                {"opensees", opensees},
                                {"rows", rows}}
             .dump(1) +
         "\n";
}

std::string to_text(const SolverReport& report) {
  std::string text =
      fmt::format("{}, {} processors\n", report.machine.cpu, report.machine.processors);
  text +=
      "    dof  path      step         p50         p99       p99.9  critical p50, p99     misses  "
      "excused  OpenSees over it\n";
  for (const auto& row : report.rows) text += line_of(row);
  return text + (report.has_opensees
                     ? fmt::format("OpenSees {}: {}\n", report.opensees, kOpenSeesSettings)
                     : fmt::format("OpenSees is NOT measured: {}\n", report.opensees));
}

}  // namespace rths::bench

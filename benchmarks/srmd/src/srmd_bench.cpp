// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/srmd_bench.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/statistics.hpp>
#include <rths/core/error.hpp>
#include <rths/core/sha256.hpp>
#include <rths/core/side_by_side.hpp>
#include <rths/maths/delay.hpp>
#include <rths/sim/floor_spectrum.hpp>
#include <rths/sim/machine/platen_run.hpp>

#include "finished_tests.hpp"
#include "hybrid_loop.hpp"

namespace rths::bench {
namespace {

constexpr std::size_t kRest = 1000;    // samples before the first target
constexpr std::size_t kWindow = 2000;  // samples
constexpr double kSearch = 0.15;       // largest delay [s]
constexpr double kStrong = 0.2;        // of the strongest window's rms [-]
constexpr int kMostJobs = 256;

struct Record {
  const char* name;
  const char* file;
  std::array<int, 3> columns;  // long, lat, vert
  double scale;                // as in the example experiments
  bool is_2d;
};
constexpr Record kRecords[] = {
    {"petrolia 1-D", "petrolia_1992_riodell_freefield.csv", {2, 1, 3}, 1.4, false},
    {"petrolia 2-D", "petrolia_1992_riodell_freefield.csv", {2, 1, 3}, 1.4, true},
    {"imperial valley 2-D", "imperial_valley_1979_meloland_freefield.csv", {1, 2, 3}, 1.0, true}};

sim::GroundMotion read_motion(const Record& record, const std::filesystem::path& folder) {
  sim::GroundMotion motion = sim::read_motion(folder / record.file, record.columns, record.scale);
  if (!record.is_2d) std::fill(motion.lat_acceleration.begin(), motion.lat_acceleration.end(), 0.0);
  return motion;
}

double rms(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double largest(std::span<const double> values) {
  double found = 0;
  for (const double value : values) found = std::max(found, std::abs(value));
  return found;
}

double delay_of(std::span<const double> command, std::span<const double> measured) {
  return maths::identify_delay(command, measured, kPeriod, kSearch).cross_correlation;
}

std::vector<double> strong_windows(const AxisHistory& axis) {
  std::vector<double> strengths;
  for (std::size_t at = kRest; at + kWindow <= axis.command.size(); at += kWindow)
    strengths.push_back(rms(std::span{axis.command}.subspan(at, kWindow)));
  std::vector<double> delays;
  for (std::size_t i = 0; i < strengths.size(); ++i) {
    if (strengths[i] < kStrong * *std::max_element(strengths.begin(), strengths.end())) continue;
    const std::size_t at = kRest + i * kWindow;
    delays.push_back(delay_of(std::span{axis.command}.subspan(at, kWindow),
                              std::span{axis.measured}.subspan(at, kWindow)));
  }
  return delays;
}

void add_coefficients(const AxisHistory& history, SrmdAxis& axis) {
  const std::span coefficients = std::span{history.coefficients}.subspan(kRest);
  axis.lowest_a1 = axis.highest_a1 = coefficients[0][1];
  double below = 0;
  for (const auto& a : coefficients) {
    below += a[0] < 1 ? 1 : 0;
    axis.lowest_a1 = std::min(axis.lowest_a1, a[1]);
    axis.highest_a1 = std::max(axis.highest_a1, a[1]);
  }
  axis.share_a0_below_1 = below / static_cast<double>(coefficients.size());
}

SrmdAxis figures_of(const char* name, const AxisHistory& history, const AxisHistory& raw,
                    const AxisHistory& fed_forward) {
  SrmdAxis axis;
  axis.name = name;
  axis.largest = largest(history.command);
  axis.raw_delay = delay_of(raw.command, raw.measured);
  axis.delay = delay_of(history.command, history.measured);
  axis.windows = strong_windows(history);
  const auto error = maths::tracking_error(history.command, history.measured);
  axis.nrms = error.nrms;
  axis.peak = error.peak;
  axis.feed_forward_overshoot = largest(fed_forward.measured) / axis.largest - 1;
  add_coefficients(history, axis);
  return axis;
}

double floor_error(const loop::ResponseHistory& test, const loop::ResponseHistory& numerical) {
  static const auto frequencies = sim::spectrum_frequencies(6, 11, 21);
  double worst = 0;
  for (std::size_t i = 0; i < numerical.floors.size(); ++i) {
    const auto& ours = test.floors[i];
    const auto& theirs = numerical.floors[i];
    const std::size_t common =
        std::min(ours.acceleration_long.size(), theirs.acceleration_long.size());
    const auto spectrum = [&](const loop::ResponseHistory::Floor& floor) {
      return sim::floor_spectrum(std::span{floor.acceleration_long}.first(common),
                                 std::span{floor.acceleration_lat}.first(common), test.time_step,
                                 frequencies, 0.05);
    };
    const auto s = spectrum(ours);
    const auto reference = spectrum(theirs);
    std::vector<double> differences;
    for (std::size_t k = 0; k < s.size(); ++k) differences.push_back(s[k] / reference[k] - 1);
    worst = std::max(worst, rms(differences));
  }
  return worst;
}

SrmdTest run_test(const PlatenTest& test, const Controller& controller,
                  const loop::ResponseHistory& numerical) {
  SrmdTest result;
  result.controller = controller.name;
  const HybridHistory history = run_hybrid(test, controller);
  result.stable = history.stable;
  result.limit_periods = history.limits;
  if (!history.stable) return result;
  const auto raw = replay(test, history, bare_controller());
  Controller feed_forward = bare_controller();
  feed_forward.feed_forward = controller.feed_forward;
  const auto fed_forward =
      feed_forward.feed_forward > 0 ? replay(test, history, feed_forward) : raw;
  for (std::size_t i = 0; i < 2; ++i)
    if (test.axes[i])
      result.axes.push_back(
          figures_of(name_of(kHorizontal[i]), history.axes[i], raw[i], fed_forward[i]));
  result.floor_error = floor_error(history.response, numerical);
  return result;
}

void measure_steps(const sim::machine::PlatenMachine& machine, SrmdReport& report) {
  constexpr int kSteps = 20'000;
  sim::machine::PlatenRun run{machine, kPeriod};
  sim::machine::PlatenReference reference;
  reference.axial_load = machine.specimen.axial_load;
  sim::machine::PlatenFeedback feedback;
  std::vector<double> times;
  for (int i = 0; i < kSteps; ++i) {
    reference.displacement[0] = 0.2 * std::sin(3.0 * i * kPeriod);
    reference.displacement[1] = 0.1 * std::sin(5.0 * i * kPeriod);
    const auto begun = std::chrono::steady_clock::now();
    static_cast<void>(run.step(reference, feedback));
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  }
  std::sort(times.begin(), times.end());
  report.step_p50 = quantile(times, 0.5);
  report.step_p99 = quantile(times, 0.99);
  report.step_worst = times.back();
}

void check(const SrmdOptions& options) {
  const auto within = [](const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw Error{fmt::format("bench srmd: {} is {}, expected {} to {}", name, value, low, high)};
  };
  within("jobs", options.jobs, 1, kMostJobs);
  within("draws", options.draws, 0, sim::machine::kFamilySize);
  within("records", options.records, 1, std::size(kRecords));
  within("duration", options.duration, 10, 1000);
}

/// All that the tests share.
struct Bench {
  const SrmdOptions& options;
  sim::machine::PlatenMachine nominal;
  sim::IsolatedPlant plant;
  sim::Bearing bearing;
  std::vector<Controller> controllers;
};

Bench read_bench(const SrmdOptions& options) {
  auto nominal = sim::machine::read_platen_machine(Config::load(options.machine));
  const auto plant = sim::example_plant();
  auto bearing = sim::read_bearing(Config::load(options.bearing), sim::weight_per_bearing(plant));
  // A further controller is a further column.
  std::vector<Controller> controllers{
      paper_controller(), inverse_controller(nominal, bearing, Config::load(options.constants))};
  return {options, nominal, plant, std::move(bearing), std::move(controllers)};
}

// What the result of a test depends on, beside its name.
std::string origin_of(const SrmdOptions& options) {
  std::string files;
  for (const auto& file : {options.machine, options.bearing, options.constants})
    files += sha256_of(file);
  for (const auto& record : kRecords) files += sha256_of(options.records_folder / record.file);
  return nlohmann::ordered_json{{"format", 1},
                                {"program", sha256_of("/proc/self/exe")},
                                {"files", sha256(files)},
                                {"duration_s", options.duration}}
      .dump();
}

void run_row(const Bench& bench, int member, const Record& record, FinishedTests& finished,
             const std::function<void()>& progress) {
  const auto drawn = sim::machine::family_member(bench.nominal, member);
  auto machine = drawn.machine;
  machine.specimen = sim::machine::with_stiffness(bench.bearing, drawn.specimen_stiffness);
  const PlatenTest test{.machine = machine,
                        .at_rest = {machine, kPeriod},
                        .plant = sim::assemble(bench.plant),
                        .motion = read_motion(record, bench.options.records_folder),
                        .duration = bench.options.duration,
                        .axes = {true, record.is_2d}};
  std::optional<loop::ResponseHistory> numerical;
  for (const auto& controller : bench.controllers) {
    const TestName name{member, record.name, controller.name};
    if (finished.contains(name)) continue;
    if (!numerical) numerical = numerical_loop(test);
    finished.add(name, run_test(test, controller, *numerical));
    progress();
  }
}

void run_rows(const Bench& bench, FinishedTests& finished) {
  const SrmdOptions& options = bench.options;
  const auto rows = static_cast<std::size_t>((options.draws + 1) * options.records);
  const std::size_t tests = rows * bench.controllers.size();
  std::mutex reporting;
  const auto progress = [&] {
    if (!options.progress) return;
    const std::lock_guard lock{reporting};
    options.progress(fmt::format("{} of {} tests", finished.size(), tests));
  };
  progress();
  const auto run = [&](std::size_t row) {
    const int number = static_cast<int>(row);
    run_row(bench, number / options.records, kRecords[number % options.records], finished,
            progress);
  };
  side_by_side(rows, run, static_cast<std::size_t>(options.jobs));
}

}  // namespace

SrmdReport run_srmd_bench(const SrmdOptions& options) {
  check(options);
  const Bench bench = read_bench(options);
  FinishedTests finished{options.partial, origin_of(options)};
  run_rows(bench, finished);
  SrmdReport report;
  report.host = describe_machine();
  report.options = options;
  for (int member = 0; member <= options.draws; ++member)
    for (int r = 0; r < options.records; ++r) {
      SrmdRow row{member, kRecords[r].name, {}};
      for (const auto& controller : bench.controllers)
        row.tests.push_back(finished.at({member, row.record, controller.name}));
      report.rows.push_back(std::move(row));
    }
  auto machine = bench.nominal;
  machine.specimen = bench.bearing;
  measure_steps(machine, report);
  return report;
}

}  // namespace rths::bench

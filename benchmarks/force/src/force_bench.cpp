// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/force_bench.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <rths/bench/report.hpp>
#include <rths/controller/force_observer.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/low_pass.hpp>

#include "empty_table.hpp"

namespace rths::bench {
namespace {

using controller::TableForce;

constexpr double kSample = 1e-3;
constexpr double kCutoff = 60;                  // of the observer [Hz]
constexpr std::size_t kSettled = 2000;          // samples of a run before its residual counts
constexpr double kLoads[] = {8e6, 12e6, 10e6};  // mean axial load of the three runs [N]

struct Parameter {
  const char* name;
  double TableForce::*value;
};
constexpr std::array<Parameter, 7> kParameters = {
    {{"effective_mass", &TableForce::effective_mass},
     {"coulomb_friction", &TableForce::coulomb_friction},
     {"load_friction", &TableForce::load_friction},
     {"viscous_friction", &TableForce::viscous_friction},
     {"offset", &TableForce::offset},
     {"presliding", &TableForce::presliding},
     {"accelerometer_delay", &TableForce::accelerometer_delay}}};

struct Residual {
  double sum = 0, peak = 0;
  std::size_t count = 0;
  void add(double value) {
    sum += value * value;
    peak = std::max(peak, std::abs(value));
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(sum / static_cast<double>(count)); }
};

void keep(ForceResiduals& all, const Residual& residual) {
  all.rms.push_back(residual.rms());
  all.peak.push_back(residual.peak);
}

Residual corrected(controller::TableForceObserver& observer, const TableRun& run) {
  Residual residual;
  for (std::size_t i = 0; i < run.force.size(); ++i) {
    const double left =
        observer.step({run.displacement[i], run.acceleration[i], run.force[i], run.axial_load[i]});
    if (i >= kSettled) residual.add(left);
  }
  return residual;
}

// Equation 1 of the paper, identified from both runs one after the other, behind the same low-pass.
Residual corrected_as_in_the_paper(const TableRun& first, const TableRun& second,
                                   const TableRun& run) {
  const auto joined = [&](auto member) {
    std::vector<double> all = first.*member;
    all.insert(all.end(), (second.*member).begin(), (second.*member).end());
    return all;
  };
  const auto found = controller::identify_machine_force(joined(&TableRun::displacement),
                                                        joined(&TableRun::acceleration),
                                                        joined(&TableRun::force), kSample);
  controller::ForceObserver observer{found.machine, kSample};
  maths::LowPass filter{2, kCutoff, kSample};
  Residual residual;
  for (std::size_t i = 0; i < run.force.size(); ++i) {
    const double left =
        filter(observer.step(run.displacement[i], run.acceleration[i], run.force[i]));
    if (i >= kSettled) residual.add(left);
  }
  return residual;
}

void judge_seed(ForceReport& report, int seed) {
  std::mt19937_64 random{static_cast<std::uint64_t>(seed)};
  const EmptyTable machine = draw_machine(random);
  const TableRun harmonic =
      drive(machine, TableMotion::Harmonic, kLoads[0], report.duration, random);
  const TableRun quake =
      drive(machine, TableMotion::Earthquake, kLoads[1], report.duration, random);
  const TableRun unseen =
      drive(machine, TableMotion::Earthquake, kLoads[2], report.duration, random);
  for (const TableRun* run : {&harmonic, &quake, &unseen})
    report.largest_acceleration = std::max(report.largest_acceleration, run->largest_acceleration);

  const std::array<controller::TableRecording, 2> runs = {harmonic.view(), quake.view()};
  const auto found = controller::identify_table_force(runs, {});
  const TableForce truth = machine.truth();
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    const auto value = kParameters[i].value;
    const double error = std::abs(found.machine.*value - truth.*value);
    if (error <= found.half_width.*value) ++report.parameters[i].covered;
    report.parameters[i].largest_error =
        std::max(report.parameters[i].largest_error, error / std::abs(truth.*value));
  }
  controller::TableForceObserver observer{found.machine, {.period = kSample, .cutoff = kCutoff}};
  report.largest_lag = std::max(report.largest_lag, observer.lag());
  keep(report.ours, corrected(observer, unseen));
  keep(report.paper, corrected_as_in_the_paper(harmonic, quake, unseen));
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

Json document(const ForceResiduals& residuals) {
  return {{"rms_median_N", median(residuals.rms)},
          {"rms_largest_N", largest(residuals.rms)},
          {"peak_median_N", median(residuals.peak)},
          {"peak_largest_N", largest(residuals.peak)}};
}

}  // namespace

ForceReport run_force_bench(const ForceOptions& options) {
  if (options.seeds < 1) throw Error{"force bench: expected at least one seed"};
  ForceReport report;
  report.seeds = options.seeds;
  report.duration = options.duration;
  report.cutoff = kCutoff;
  for (const auto& parameter : kParameters) report.parameters.push_back({parameter.name});
  for (int seed = 1; seed <= options.seeds; ++seed) {
    if (options.progress) options.progress(fmt::format("{} of {}", seed, options.seeds));
    judge_seed(report, seed);
  }
  const double needed = kCoverageGoal * options.seeds;
  const bool covered = std::all_of(report.parameters.begin(), report.parameters.end(),
                                   [&](const auto& p) { return p.covered >= needed; });
  const bool corrects =
      largest(report.ours.rms) <= kForceRmsGoal && largest(report.ours.peak) <= kForcePeakGoal;
  report.result = covered && corrects ? GateResult::Pass : GateResult::Fail;
  return report;
}

std::string to_json(const ForceReport& report) {
  Json out = {
      {"result", to_text(report.result)},
      {"seeds", report.seeds},
      {"duration_s", report.duration},
      {"largest_acceleration_m_per_s2", report.largest_acceleration},
      {"cutoff_Hz", report.cutoff},
      {"largest_lag_s", report.largest_lag},
      {"goals", {{"rms_N", kForceRmsGoal}, {"peak_N", kForcePeakGoal}, {"covered", kCoverageGoal}}},
      {"ours", document(report.ours)},
      {"paper", document(report.paper)},
      {"parameters", Json::object()}};
  for (const auto& parameter : report.parameters)
    out["parameters"][parameter.name] = {{"covered", parameter.covered},
                                         {"largest_relative_error", parameter.largest_error}};
  return written(1, out);
}

std::string to_text(const ForceReport& report) {
  std::string out = fmt::format(
      "{} machines, empty table to {:.1f} m/s²; low-pass {:.0f} Hz, lag at most {:.1f} ms\n\n"
      "{:<34}{:>12}{:>12}{:>12}{:>12}\n",
      report.seeds, report.largest_acceleration, report.cutoff, report.largest_lag * 1e3,
      "residual on another run [kN]", "RMS median", "largest", "peak median", "largest");
  const auto row = [&](const char* name, const ForceResiduals& r) {
    out += fmt::format("{:<34}{:>12.2f}{:>12.2f}{:>12.2f}{:>12.2f}\n", name, median(r.rms) * 1e-3,
                       largest(r.rms) * 1e-3, median(r.peak) * 1e-3, largest(r.peak) * 1e-3);
  };
  row("load, presliding, accelerometer", report.ours);
  row("equation 1 of the paper", report.paper);
  out += fmt::format("\n{:<34}{:>12}{:>16}\n", "parameter", "covered", "largest error");
  for (const auto& parameter : report.parameters)
    out += fmt::format("{:<34}{:>12}{:>14.2f} %\n", parameter.name, parameter.covered,
                       parameter.largest_error * 100);
  return out + conclusion(report.result, {});
}

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/vertical_bench.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include <rths/bench/report.hpp>
#include <rths/controller/vertical_force.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/delay.hpp>

#include "vertical_command.hpp"
#include "vertical_plant.hpp"

namespace rths::bench {
namespace {

constexpr double kTick = 1e-3;
constexpr double kSlow = 10;      // rate of the slow test
constexpr double kSettled = 4.0;  // of the command's time, before the figures count [s]
constexpr double kSearch = 0.04;  // of the delay [s]
constexpr double kUnstable = 0.5;
constexpr double kSegment = 2.0;                          // of the coherence [s]
constexpr double kLowestBand = 1.0, kHighestBand = 15.0;  // band of the coherence [Hz]

// A controller: force target, measured force, horizontal target and measurement → reference.
using Controller = std::function<double(double, double, double, double)>;

std::complex<double> fourier(const double* signal, std::size_t length, double mean, double omega) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < length; ++i) {
    const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(i) /
                                               static_cast<double>(length));
    const double angle = -omega * static_cast<double>(i);
    sum += window * (signal[i] - mean) * std::complex<double>{std::cos(angle), std::sin(angle)};
  }
  return sum;
}

// Smallest coherence over the band, by Welch's method with half-overlapping segments.
double smallest_coherence(const std::vector<double>& command, const std::vector<double>& force,
                          double sample) {
  const auto length = static_cast<std::size_t>(std::lround(kSegment / sample));
  double mean = 0;
  for (const double value : command) mean += value / static_cast<double>(command.size());
  double smallest = 1;
  for (double frequency = kLowestBand; frequency <= kHighestBand; frequency += 1 / kSegment) {
    const double omega = 2 * std::numbers::pi * frequency * sample;
    std::complex<double> cross = 0;
    double power = 0, response = 0;
    for (std::size_t begin = 0; begin + length <= command.size(); begin += length / 2) {
      const auto c = fourier(&command[begin], length, mean, omega);
      const auto f = fourier(&force[begin], length, mean, omega);
      cross += std::conj(c) * f;
      power += std::norm(c);
      response += std::norm(f);
    }
    smallest = std::min(smallest, std::norm(cross) / (power * response));
  }
  return smallest;
}

ForceTracking track(const VerticalMachine& machine, const VerticalCommand& command, double rate,
                    const Controller& controller) {
  VerticalRun run{machine, kPreload, 17};
  const long ticks = std::lround(command.duration() * rate / kTick);
  const long every = std::lround(rate);  // samples at 1 kHz of the command's time
  std::vector<double> wanted, found;
  for (long i = 0; i < ticks; ++i) {
    const double time = static_cast<double>(i) * kTick / rate;
    const double target = command.force(time);
    const double horizontal = command.horizontal(time);
    const double reference =
        controller(target, run.measured_force(), horizontal, run.measured_horizontal());
    if (time > kSettled && i % every == 0) {
      wanted.push_back(target);
      found.push_back(run.force());
    }
    run.step(reference, command.horizontal(time + kTick / rate));
  }
  ForceTracking result;
  const auto [low, high] = std::minmax_element(wanted.begin(), wanted.end());
  const auto error = maths::tracking_error(wanted, found);
  result.rms = error.rms / (*high - *low);
  result.stable = result.rms < kUnstable;
  if (!result.stable) return result;
  result.delay = maths::identify_delay(wanted, found, kTick, kSearch).cross_correlation;
  result.coherence = smallest_coherence(wanted, found, kTick);
  return result;
}

// What a laboratory knows of every machine: nominal values.
controller::VerticalForceSettings assumed() {
  controller::VerticalForceSettings settings = controller::srmd_vertical();
  settings.bearing.stiffness = 5e9;
  settings.bearing.softening = 37.5;
  settings.bearing.lift_radius = 10;
  return settings;
}

Controller ours(const controller::VerticalForceSettings& settings) {
  return [control = controller::VerticalForceControl{settings}](
             double target, double measured, double horizontal_target, double horizontal) mutable {
    return control.step(target, measured, horizontal_target, horizontal);
  };
}

Controller cascade() {
  return [control = controller::ForceCascade{{}}](double target, double measured, double,
                                                  double) mutable {
    return control.step(target, measured);
  };
}

Controller without_kinematics() {
  auto settings = assumed();
  settings.bearing.lift_radius = 0;
  return ours(settings);
}

Controller without_observer() {
  auto settings = assumed();
  settings.observer_bandwidth = 0;
  return ours(settings);
}

Controller without_learning() {
  return [control = controller::VerticalForceControl{assumed()}](
             double target, double measured, double horizontal_target, double horizontal) mutable {
    return control.step(target, measured, horizontal_target, horizontal, false);
  };
}

struct Kind {
  const char* name;
  const char* title;
  double rate;
  Controller (*make)();
  bool all_draws;
};
constexpr Kind kKinds[] = {
    {"cascade", "cascade of the paper", 1, cascade, true},
    {"cascade_slow", "cascade, ten times slower", kSlow, cascade, false},
    {"ours", "ours", 1, [] { return ours(assumed()); }, true},
    {"without_kinematics", "ours without height change", 1, without_kinematics, false},
    {"without_observer", "ours without disturbance observer", 1, without_observer, false},
    {"without_learning", "ours without learning", 1, without_learning, false}};
constexpr int kFewDraws = 10;  // of the rows that are not judged on all draws

double worst(const VerticalRow& row, double ForceTracking::*value, bool is_lowest = false) {
  double found = is_lowest ? 1 : 0;
  for (const auto& draw : row.draws)
    found = is_lowest ? std::min(found, draw.*value) : std::max(found, std::abs(draw.*value));
  return found;
}

double middle(const VerticalRow& row, double ForceTracking::*value) {
  std::vector<double> values;
  for (const auto& draw : row.draws) values.push_back(std::abs(draw.*value));
  return median(values);
}

bool all_stable(const VerticalRow& row) {
  return std::all_of(row.draws.begin(), row.draws.end(), [](const auto& d) { return d.stable; });
}

bool meets_goals(const VerticalRow& row) {
  return all_stable(row) && worst(row, &ForceTracking::delay) <= kVerticalDelayGoal &&
         worst(row, &ForceTracking::rms) <= kVerticalRmsGoal &&
         worst(row, &ForceTracking::coherence, true) >= kVerticalCoherenceGoal;
}

Json document(const VerticalRow& row) {
  const auto stable =
      std::count_if(row.draws.begin(), row.draws.end(), [](const auto& d) { return d.stable; });
  const auto of = [](const ForceTracking& t) {
    return Json{{"delay_s", t.delay}, {"rms", t.rms}, {"coherence", t.coherence}};
  };
  return {{"title", row.title},
          {"rate", row.rate},
          {"draws", row.draws.size()},
          {"stable", stable},
          {"nominal", of(row.draws.front())},
          {"median", of({middle(row, &ForceTracking::delay), middle(row, &ForceTracking::rms),
                         middle(row, &ForceTracking::coherence)})},
          {"worst", of({worst(row, &ForceTracking::delay), worst(row, &ForceTracking::rms),
                        worst(row, &ForceTracking::coherence, true)})},
          {"meets_goals", meets_goals(row)}};
}

}  // namespace

VerticalReport run_vertical_bench(const VerticalOptions& options) {
  if (options.draws < 1) throw Error{"vertical bench: expected at least one draw"};
  if (!(options.duration >= 2 * kSettled))
    throw Error{fmt::format("vertical bench: duration is {} s, expected at least {} s",
                            options.duration, 2 * kSettled)};
  VerticalReport report;
  report.draws = options.draws;
  report.duration = options.duration;
  const VerticalCommand command{options.duration};
  for (const Kind& kind : kKinds) report.rows.push_back({kind.name, kind.title, kind.rate, {}});
  for (int draw = 0; draw <= options.draws; ++draw) {
    if (options.progress) options.progress(fmt::format("{} of {}", draw, options.draws));
    for (std::size_t i = 0; i < report.rows.size(); ++i)
      if (kKinds[i].all_draws || draw <= kFewDraws)
        report.rows[i].draws.push_back(
            track(draw_vertical(draw), command, kKinds[i].rate, kKinds[i].make()));
  }
  const VerticalRow& paper = report.rows[0];
  const VerticalRow& slow = report.rows[1];
  const bool as_published =
      !meets_goals(paper) && worst(slow, &ForceTracking::rms) <= kVerticalRmsGoal;
  report.result = meets_goals(report.rows[2]) && as_published ? GateResult::Pass : GateResult::Fail;
  return report;
}

std::string to_json(const VerticalReport& report) {
  Json out = {{"result", to_text(report.result)},
              {"draws", report.draws},
              {"duration_s", report.duration},
              {"goals",
               {{"delay_s", kVerticalDelayGoal},
                {"rms", kVerticalRmsGoal},
                {"coherence", kVerticalCoherenceGoal}}},
              {"rows", Json::object()}};
  for (const auto& row : report.rows) out["rows"][row.name] = document(row);
  return written(1, out);
}

std::string to_text(const VerticalReport& report) {
  std::string out = fmt::format("{:<36}{:>6}{:>8}{:>18}{:>20}{:>20}\n", "vertical force", "draws",
                                "stable", "delay ms", "RMS / p-p %", "coherence to 15 Hz");
  for (const auto& row : report.rows)
    out += fmt::format(
        "{:<36}{:>6}{:>8}{:>9.2f}{:>9.2f}{:>10.2f}{:>10.2f}{:>10.3f}{:>10.3f}\n", row.title,
        row.draws.size(),
        std::count_if(row.draws.begin(), row.draws.end(), [](const auto& d) { return d.stable; }),
        middle(row, &ForceTracking::delay) * 1e3, worst(row, &ForceTracking::delay) * 1e3,
        middle(row, &ForceTracking::rms) * 100, worst(row, &ForceTracking::rms) * 100,
        middle(row, &ForceTracking::coherence), worst(row, &ForceTracking::coherence, true));
  return out + "median and worst of the draws\n" + conclusion(report.result, {});
}

}  // namespace rths::bench

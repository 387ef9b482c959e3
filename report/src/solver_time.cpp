// SPDX-License-Identifier: Apache-2.0
#include "solver_time.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/maths/statistics.hpp>

#include "analysis.hpp"

namespace rths::report {
namespace {

constexpr double kStepTolerance = 1e-3;   // of an integration step
constexpr double kTimeRounding = 2.4e-7;  // of two times of type f32 [-]
constexpr double kRestOfTarget = 5e-5;    // smaller targets are rounding of a static analysis [m]
constexpr double kRestShareOfTarget = 0.01;        // the same, of the largest target [-]
constexpr double kRowsOfAMove = 4;                 // longer moves are seen one by one
constexpr double kSlowest = 1.25, kFastest = 0.9;  // of the planned rate
constexpr std::size_t kFewMoves = 50;              // show no rate, and may repeat a target
constexpr double kLargestTarget = 10;              // [m]; that of the largest test machines is 3 m
constexpr double kAbruptStop = 0.01;               // of the largest step between targets
constexpr double kMissedTargets = 4;  // rows that are 1 ms apart see at least one flag of four

std::string time_signal(const Reader& run, const Roles& roles) {
  for (const std::string& name : {"monitor." + roles.solver + ".time", roles.time})
    if (run.has(name)) {
      const auto time = run.signal(name);
      if (std::ranges::any_of(time, [](double t) { return t != 0; })) return name;
    }
  return "";
}

// Number of moves until each row. The solver's own count lacks moves that identify a stiffness.
std::vector<double> moves_in(const Reader& run, const Roles& roles) {
  const std::string solved = "monitor." + roles.solver + ".step";
  return run.has(solved) ? run.signal(solved) : targets_of(run, roles);
}

double flags_in(const Reader& run, const Roles& roles) {
  if (!run.has(roles.new_target)) return 0;
  double flags = 0, before = 0;
  for (const double flag : run.signal(roles.new_target)) {
    if (flag > 0 && flag != before) ++flags;
    before = flag;
  }
  return flags;
}

// Targets of a test. A solver that raises no flag sends none, whatever it writes.
double targets_in(const Reader& run, const Roles& roles, bool is_counted) {
  const double targets = largest(moves_in(run, roles));
  return is_counted ? targets : std::min(targets, kMissedTargets * flags_in(run, roles));
}

// First rows of each count.
std::vector<std::size_t> starts_of(const std::vector<double>& count, std::size_t rows) {
  std::vector<std::size_t> starts;
  double before = 0;
  for (std::size_t row = 0; row < std::min(rows, count.size()); ++row) {
    if (count[row] > before) starts.push_back(row);
    before = std::max(before, count[row]);
  }
  return starts;
}

// Rows from count to count.
double usual_rows_of(const std::vector<std::size_t>& starts) {
  std::vector<double> lengths;
  for (std::size_t i = 1; i < starts.size(); ++i)
    lengths.push_back(static_cast<double>(starts[i] - starts[i - 1]));
  return maths::quantile(std::move(lengths), 0.5);
}

// Rows from a count to the middle of its move: words and count can lie in different rows.
std::size_t half_of_a_move(const std::vector<std::size_t>& starts) {
  return static_cast<std::size_t>(usual_rows_of(starts)) / 2;
}

// Rows at which each move is read.
std::vector<std::size_t> readings_of(const std::vector<std::size_t>& starts, std::size_t rows) {
  const std::size_t half = half_of_a_move(starts);
  std::vector<std::size_t> readings;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : rows;
    readings.push_back(starts[i] + std::min(half, (end - starts[i]) / 2));
  }
  return readings;
}

// The first move with a target away from rest.
std::size_t first_from_rest(const Reader& run, const Roles& roles,
                            const std::vector<std::size_t>& readings) {
  std::size_t first = readings.size();
  for (const auto& axis : roles.axes) {
    if (!run.has(axis.target)) continue;
    const auto target = run.signal(axis.target);
    const double origin = target.empty() ? 0 : target.front();
    double largest = 0;
    for (const auto row : readings) largest = std::max(largest, std::abs(target[row] - origin));
    const double rest = std::min(kRestOfTarget, kRestShareOfTarget * largest);
    const auto leaves = std::ranges::find_if(
        readings, [&](std::size_t row) { return std::abs(target[row] - origin) > rest; });
    first = std::min(first, static_cast<std::size_t>(leaves - readings.begin()));
  }
  return first == readings.size() ? 0 : first;
}

/// Moves that do not advance the time by one step.
struct Departures {
  std::size_t back = 0, repeated = 0, shorter = 0, longer = 0;
  double first = 0;  ///< [s]
  [[nodiscard]] std::size_t count() const { return back + repeated + shorter + longer; }
};

// Rows can miss moves: of those that lie between two rows, only the sum is known, and no more than
// have the time for it.
double moves_between(const SolverMove& before, const SolverMove& move, const SolverTime& solver,
                     double step) {
  if (solver.is_counted) return move.count - before.count;
  const double missed = std::max(1.0, std::round((move.time - before.time) / step));
  if (solver.usual_move == 0) return missed;
  return std::min(missed, std::max(1.0, std::round((move.at - before.at) / solver.usual_move)));
}

void classify(const SolverMove& before, const SolverMove& move, const SolverTime& solver,
              double step, Departures& found) {
  const double advance = move.time - before.time;
  const double tolerance = kStepTolerance * step + kTimeRounding * std::abs(move.time);
  const double missed = moves_between(before, move, solver, step);
  if (std::abs(advance - missed * step) <= missed * tolerance) return;
  if (found.count() == 0) found.first = move.at;
  if (advance < -tolerance)
    ++found.back;
  else if (advance <= tolerance)
    ++found.repeated;
  else
    ++(advance < missed * step ? found.shorter : found.longer);
}

std::string described(const Departures& found, std::size_t moves) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(found.back, "go back");
  add(found.repeated, "repeat the time (iterations)");
  add(found.shorter, "advance it by less (parts of a step)");
  add(found.longer, "advance it by more");
  return fmt::format("of {} moves, {}", moves, text);
}

}  // namespace

SolverTime solver_time_of(const Reader& run) {
  const Roles roles = recording::roles_of(run);
  SolverTime solver;
  solver.signal = time_signal(run, roles);
  solver.counter = roles.new_target;
  for (const auto& counter :
       {roles.monitor_of_controller() + "pc.targets", "monitor." + roles.solver + ".step"})
    if (run.has(counter)) {
      solver.is_counted = true;
      solver.counter = counter;
    }
  const auto count = moves_in(run, roles);
  const std::size_t rows = test_rows(run);
  const auto starts = starts_of(count, rows), readings = readings_of(starts, rows);
  const auto time = solver.signal.empty() ? std::vector<double>{} : run.signal(solver.signal);
  for (std::size_t i = 0; i < starts.size(); ++i)
    solver.moves.push_back({run.time()[starts[i]], readings[i], count[starts[i]],
                            time.empty() ? 0.0 : time[readings[i]]});
  if (starts.size() > 1 && usual_rows_of(starts) >= kRowsOfAMove)
    solver.usual_move = usual_rows_of(starts) * (run.time()[1] - run.time()[0]);
  solver.start = first_from_rest(run, roles, readings);
  return solver;
}

double reached_in(const Reader& run, const SolverTime& solver, const Config& experiment,
                  bool is_completed) {
  const double step = experiment.number("integration_step_s", 0.01);
  const Roles roles = recording::roles_of(run);
  if (!solver.moves.empty() && !solver.signal.empty()) return solver.moves.back().time;
  // A count of OpenSees lacks the trials that repeat the one before, as the first.
  const auto opensees = recording::node_with(experiment.table_or_empty("node"), {"opensees"});
  if (opensees && run.has("monitor." + *opensees + ".step"))
    return (largest(run.signal("monitor." + *opensees + ".step")) + 1) * step;
  if (solver.is_counted || run.has(roles.new_target))
    return targets_in(run, roles, solver.is_counted) * step;
  if (is_completed) return experiment.number("duration_s");
  return model_time_at(run.time().empty() ? 0 : run.time().back(), experiment.number("rest_s", 0),
                       experiment.number("rate", 1));
}

Break time_of(const SolverTime& solver, double step) {
  if (solver.signal.empty()) return {};
  Departures found;
  for (std::size_t i = solver.start + 1; i < solver.moves.size(); ++i)
    classify(solver.moves[i - 1], solver.moves[i], solver, step, found);
  if (found.count() == 0) return {};
  return Broken{"time", found.first, solver.signal, described(found, solver.moves.size()),
                fmt::format("each advances it by {:g} s", step)};
}

Break rate_of(const SolverTime& solver, double rate, double step) {
  if (solver.moves.size() < solver.start + kFewMoves) return {};
  const auto achieved = achieved_rate(solver, step);
  if (!achieved || (*achieved <= kSlowest * rate && *achieved >= kFastest * rate)) return {};
  return Broken{"rate", solver.moves[solver.start].at,
                solver.signal.empty() ? solver.counter : solver.signal,
                fmt::format("{:.3g} s for each second of the solver", *achieved),
                fmt::format("{:g} s, from {:g} to {:g} s", rate, kFastest * rate, kSlowest * rate)};
}

Break targets_limit_of(const Reader& run, const SolverTime& solver) {
  for (const auto& axis : recording::roles_of(run).axes) {
    if (!run.has(axis.target)) continue;
    const auto target = run.signal(axis.target);
    for (const auto& move : solver.moves)
      if (std::abs(target[move.row]) > kLargestTarget)
        return Broken{"limit", move.at, axis.target, fmt::format("{:.4g} m", target[move.row]),
                      fmt::format("at most {:g} m: is it in mm?", kLargestTarget)};
  }
  return {};
}

Break targets_live_of(const Reader& run, const SolverTime& solver) {
  const auto& moves = solver.moves;
  for (const auto& axis : recording::roles_of(run).axes) {
    if (!run.has(axis.target)) continue;
    const auto target = run.signal(axis.target);
    const auto advance = [&](std::size_t i) {
      return std::abs(target[moves[i].row] - target[moves[i - 1].row]);
    };
    double largest = 0;
    for (std::size_t i = 1; i < moves.size(); ++i) largest = std::max(largest, advance(i));
    std::size_t last = 0, same = 0;  // the last move with another target; those after it
    for (std::size_t i = solver.start + 1; i < moves.size(); ++i) {
      if (advance(i) > 0) last = i;
      same = i - last;
      if (last > 0 && same >= kFewMoves && advance(last) > kAbruptStop * largest)
        return Broken{"live", moves[last].at, axis.target,
                      fmt::format("the same target in {} moves, after steps of up to {:.3g} mm",
                                  same, 1e3 * largest),
                      "targets that come to rest gradually"};
    }
  }
  return {};
}

std::optional<double> achieved_rate(const SolverTime& solver, double step) {
  if (solver.moves.size() < solver.start + 2) return std::nullopt;
  const SolverMove &first = solver.moves[solver.start], &last = solver.moves.back();
  const double model =
      solver.signal.empty() ? (last.count - first.count) * step : last.time - first.time;
  if (!(model > 0)) return std::nullopt;
  return (last.at - first.at) / model;
}

}  // namespace rths::report

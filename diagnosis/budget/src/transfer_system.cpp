// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/transfer_system.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/identification/least_squares.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::budget {
namespace {

using sim::AxisTransfer;
using sim::predicted;
using sim::TransferRecord;

constexpr double kWindow = 2;          // fitted and scored in turn [s]
constexpr double kShortest = 8;        // [s]
constexpr double kLongestDelay = 0.2;  // searched [s]

/// A fitted parameter, with its place in the system.
struct Fitted {
  const char* name;
  const char* unit;
  double AxisTransfer::*member;
  double low, high, scale;
};

constexpr Fitted kFitted[] = {
    {"gain", "1/s", &AxisTransfer::gain, 1, 500, 20},
    {"transport_delay", "s", &AxisTransfer::transport_delay, 0, 0.1, 0.002},
    {"valve_frequency", "Hz", &AxisTransfer::valve_frequency, 1, 100, 10},
    {"valve_damping", "1", &AxisTransfer::valve_damping, 0.1, 5, 1},
    {"dead_band", "m", &AxisTransfer::dead_band, 0, 0.02, 5e-4},
    {"pressure_feedback", "m/(s.N)", &AxisTransfer::pressure_feedback, 0, 1e-6, 1e-8},
    {"pressure_washout", "Hz", &AxisTransfer::pressure_washout, 0, 20, 1},
    {"compliance", "m/N", &AxisTransfer::compliance, 1e-11, 1e-7, 1e-9},
    {"supply_force", "N", &AxisTransfer::supply_force, 1e3, 1e9, 1e7},
    {"leakage", "m/(s.N)", &AxisTransfer::leakage, 0, 1e-6, 1e-9},
};
constexpr auto kCount = static_cast<Eigen::Index>(std::size(kFitted));

void check(const TransferRecord& record) {
  const std::size_t samples = record.reference.size();
  if (record.displacement.size() != samples || record.force.size() != samples)
    throw Error{
        fmt::format("transfer system: {} references, {} displacements and {} forces, "
                    "expected equally many",
                    samples, record.displacement.size(), record.force.size())};
  if (static_cast<double>(samples) * record.period < kShortest)
    throw Error{fmt::format("transfer system: {:.3g} s recorded, expected at least {} s",
                            static_cast<double>(samples) * record.period, kShortest)};
}

/// Samples of every other window.
std::vector<std::size_t> samples_of(const TransferRecord& record, std::size_t parity) {
  std::vector<std::size_t> chosen;
  const auto window = static_cast<std::size_t>(kWindow / record.period);
  for (std::size_t i = 0; i < record.displacement.size(); ++i)
    if (i / window % 2 == parity) chosen.push_back(i);
  return chosen;
}

std::vector<double> chosen_of(const std::vector<double>& values,
                              const std::vector<std::size_t>& chosen) {
  std::vector<double> result;
  for (const auto i : chosen) result.push_back(values[i]);
  return result;
}

// Share of the windows of the chosen samples in which the first error is the smaller one.
double share_of_windows(const TransferRecord& record, const std::vector<std::size_t>& chosen,
                        const std::vector<double>& error, const std::vector<double>& other) {
  const auto window = static_cast<std::size_t>(kWindow / record.period);
  std::map<std::size_t, double> gain;  // of energy, by window
  for (const auto i : chosen) gain[i / window] += other[i] * other[i] - error[i] * error[i];
  const auto better =
      std::count_if(gain.begin(), gain.end(), [](const auto& one) { return one.second > 0; });
  return static_cast<double>(better) / static_cast<double>(gain.size());
}

std::vector<double> less(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

AxisTransfer system_at(const Eigen::VectorXd& parameters) {
  AxisTransfer system;
  for (Eigen::Index i = 0; i < kCount; ++i) system.*kFitted[i].member = parameters[i];
  return system;
}

bool residual_at(const TransferRecord& record, const std::vector<std::size_t>& chosen,
                 const Eigen::VectorXd& parameters, Eigen::VectorXd& residual) {
  const auto x = predicted(system_at(parameters), record);
  residual.resize(static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    residual[static_cast<Eigen::Index>(i)] = record.displacement[chosen[i]] - x[chosen[i]];
  return residual.allFinite();
}

// Derivatives by differences, into the interior of the bounds.
bool jacobian_at(const TransferRecord& record, const std::vector<std::size_t>& chosen,
                 const Eigen::VectorXd& parameters, const Eigen::VectorXd& residual,
                 Eigen::MatrixXd& jacobian) {
  constexpr double kStep = 1e-4;  // of the scale
  jacobian.resize(residual.size(), kCount);
  Eigen::VectorXd other;
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const auto& p = kFitted[i];
    const double size = kStep * std::max(p.scale, std::abs(parameters[i]));
    const double step = parameters[i] + size > p.high ? -size : size;
    Eigen::VectorXd beside = parameters;
    beside[i] += step;
    if (!residual_at(record, chosen, beside, other)) return false;
    jacobian.col(i) = (other - residual) / step;
  }
  return true;
}

diagnosis::Fit fit(const TransferRecord& record, const std::vector<std::size_t>& chosen,
                   const AxisTransfer& start) {
  diagnosis::FitProblem problem;
  problem.rows = static_cast<Eigen::Index>(chosen.size());
  problem.start.resize(kCount);
  problem.low = problem.high = problem.scale = problem.start;
  for (Eigen::Index i = 0; i < kCount; ++i) {
    problem.low[i] = kFitted[i].low;
    problem.high[i] = kFitted[i].high;
    problem.scale[i] = kFitted[i].scale;
    problem.start[i] = std::clamp(start.*kFitted[i].member, kFitted[i].low, kFitted[i].high);
  }
  problem.most_iterations = 40;
  problem.residuals = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd& residual,
                          Eigen::MatrixXd* jacobian) {
    if (!residual_at(record, chosen, parameters, residual)) return false;
    return jacobian == nullptr || jacobian_at(record, chosen, parameters, residual, *jacobian);
  };
  return diagnosis::least_squares(problem);
}

// Half widths of the 95 % intervals, from the parameters that the record determines: those that are
// not on a bound and act. The washout of a feedback that is zero does not.
std::array<double, kCount> half_widths(const diagnosis::Fit& fitted, Eigen::Index block) {
  std::array<double, kCount> widths{};
  widths.fill(std::numeric_limits<double>::quiet_NaN());
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const double value = fitted.parameters[i], margin = 1e-6 * kFitted[i].scale;
    const bool is_inside = value > kFitted[i].low + margin && value < kFitted[i].high - margin;
    if (is_inside && fitted.jacobian.col(i).squaredNorm() > 0) inside.push_back(i);
  }
  // In units of the residual and of the scales: the numbers are then of similar size.
  const double unit =
      std::sqrt(fitted.residual.squaredNorm() / static_cast<double>(fitted.residual.size()));
  if (!(unit > 0)) return widths;
  diagnosis::Fit reduced = fitted;
  reduced.jacobian = fitted.jacobian(Eigen::all, inside) / unit;
  reduced.residual = fitted.residual / unit;
  reduced.parameters = fitted.parameters(inside);
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    reduced.jacobian.col(column) *= kFitted[inside[k]].scale;
    reduced.parameters[column] /= kFitted[inside[k]].scale;
  }
  try {
    const Eigen::MatrixXd covariance = diagnosis::covariance(reduced, block);
    for (std::size_t k = 0; k < inside.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      widths[static_cast<std::size_t>(inside[k])] =
          maths::kNormal95 * kFitted[inside[k]].scale * std::sqrt(covariance(row, row));
    }
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): not identifiable
  }
  return widths;
}

}  // namespace

double error_on(const AxisTransfer& system, const TransferRecord& record) {
  return maths::rms(less(record.displacement, predicted(system, record))) /
         maths::rms(record.displacement);
}

AxisTransfer identify_transfer(const TransferRecord& record) {
  check(record);
  const double delay =
      maths::identify_delay(record.reference, record.displacement, record.period, kLongestDelay)
          .minimum_rms;
  AxisTransfer start;
  start.gain = 1 / std::clamp(0.7 * delay, 0.002, 1.0);
  start.transport_delay = 0.1 * std::clamp(delay, 0.0, 0.2);
  start.dead_band = 1e-4;
  start.pressure_feedback = 1e-9;
  start.pressure_washout = 0.3;
  start.supply_force = std::max(1e4, 4 * maths::largest_magnitude(record.force));
  start.leakage = 1e-11;
  const auto chosen = samples_of(record, 0), scored = samples_of(record, 1);
  const auto fitted = fit(record, chosen, start);
  AxisTransfer system = system_at(fitted.parameters);
  const auto widths = half_widths(fitted, static_cast<Eigen::Index>(kWindow / record.period));
  for (std::size_t i = 0; i < widths.size(); ++i)
    system.parameters.push_back(
        {kFitted[i].name, kFitted[i].unit, system.*kFitted[i].member, widths[i]});
  const double size = maths::rms(chosen_of(record.displacement, scored));
  const auto error = less(record.displacement, predicted(system, record));
  const auto other = less(record.displacement, record.reference);
  system.confidence = share_of_windows(record, scored, error, other);
  system.residual = maths::rms(chosen_of(error, scored));
  system.error = system.residual / size;
  system.error_without = maths::rms(chosen_of(other, scored)) / size;
  return system;
}

}  // namespace rths::budget

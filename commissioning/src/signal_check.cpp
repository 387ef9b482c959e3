// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/signal_check.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <rths/commissioning/recorded.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>

namespace rths::commissioning {
namespace {

using Samples = std::vector<double>;

constexpr double kSample = 0.005;      // of the comparison [s]
constexpr double kLongestLag = 0.15;   // [s]
constexpr double kReach = 0.05;        // of a second derivative [s]
constexpr double kLeastTarget = 1e-3;  // RMS of a target [m]
constexpr double kLeastCorrelation = 0.7, kCrossed = 0.9;
constexpr std::array<double, 2> kMotionGain{0.7, 1.4}, kForceGain{0.5, 2};

/// Largest correlation by magnitude over the lags, and the slope there.
struct Likeness {
  double correlation = 0, gain = 0;
};

Likeness likeness_at(const Samples& expected, const Samples& found, std::size_t lag) {
  const std::size_t count = expected.size() - lag;
  double se = 0, sf = 0, ee = 0, ff = 0, ef = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double e = expected[i], f = found[i + lag];
    se += e;
    sf += f;
    ee += e * e;
    ff += f * f;
    ef += e * f;
  }
  const auto n = static_cast<double>(count);
  const double vee = ee - se * se / n, vff = ff - sf * sf / n, vef = ef - se * sf / n;
  if (!(vee > 0) || !(vff > 0)) return {};
  return {vef / std::sqrt(vee * vff), vef / vee};
}

Likeness likeness(const Samples& expected, const Samples& found) {
  Likeness best;
  const auto lags = static_cast<std::size_t>(std::lround(kLongestLag / kSample));
  for (std::size_t lag = 0; lag <= lags && lag + 10 < expected.size(); ++lag) {
    const auto here = likeness_at(expected, found, lag);
    if (std::abs(here.correlation) > std::abs(best.correlation)) best = here;
  }
  return best;
}

Samples thinned(const Samples& values, std::size_t every) {
  Samples result;
  for (std::size_t i = 0; i + every <= values.size(); i += every) {
    double sum = 0;
    for (std::size_t k = 0; k < every; ++k) sum += values[i + k];
    result.push_back(sum / static_cast<double>(every));
  }
  return result;
}

// Mean of the second derivative over ± kReach, weighted by a triangle.
Samples second_derivative(const Samples& x) {
  const auto reach = static_cast<std::size_t>(std::lround(kReach / kSample));
  Samples result(x.size(), 0.0);
  for (std::size_t i = reach; i + reach < x.size(); ++i)
    result[i] = (x[i + reach] - 2 * x[i] + x[i - reach]) / (kReach * kReach);
  return result;
}

Samples triangular_mean(const Samples& x) {
  const auto reach = static_cast<std::size_t>(std::lround(kReach / kSample));
  Samples result(x.size(), 0.0);
  for (std::size_t i = reach; i + reach < x.size(); ++i) {
    double sum = x[i] * static_cast<double>(reach);
    for (std::size_t k = 1; k < reach; ++k)
      sum += static_cast<double>(reach - k) * (x[i + k] + x[i - k]);
    result[i] = sum / static_cast<double>(reach * reach);
  }
  return result;
}

/// Signals of an axis by role, thinned; roles that the recording lacks are missing.
struct AxisSignals {
  recording::AxisRoles roles;
  double mass = 0;
  std::map<std::string, Samples> by_role;
  [[nodiscard]] bool has(const std::string& role) const { return by_role.count(role) > 0; }
};

AxisSignals signals_of(const recording::Reader& run, const recording::AxisRoles& roles) {
  AxisSignals signals;
  signals.roles = roles;
  for (const char* role : {"target", "command", "displacement", "force", "reference",
                           "reference_echo", "machine_displacement", "machine_acceleration",
                           "machine_force", "returned_displacement", "returned_force"}) {
    const std::string& name = signal_of(roles, role);
    if (!run.has(name)) continue;
    const auto data = recorded(run, {name});
    const auto every = static_cast<std::size_t>(std::max(1L, std::lround(kSample / data.interval)));
    signals.by_role[role] = thinned(data.values[0], every);
  }
  return signals;
}

std::string trouble_of(const SignalFinding& finding, const std::array<double, 2>& gain,
                       const std::string& other) {
  if (std::abs(finding.crossed) > kCrossed && std::abs(finding.correlation) < kLeastCorrelation)
    return fmt::format("follows the axis {}: swapped axes?", other);
  if (std::abs(finding.correlation) < kLeastCorrelation)
    return fmt::format("does not follow: correlation {:.2f}, expected at least {}",
                       finding.correlation, kLeastCorrelation);
  const double size = std::abs(finding.gain);
  std::string trouble;
  if (finding.gain < 0) trouble = "has the opposite sign";
  if (size < gain[0] || size > gain[1])
    trouble += fmt::format("{}is {:.4g} times as large, expected {:g} to {:g}: wrong unit?",
                           trouble.empty() ? "" : ", and ", size, gain[0], gain[1]);
  return trouble;
}

class Checks {
 public:
  Checks(const recording::Reader& run, const sim::TestMachine& machine,
         const sim::Bearing* specimen) {
    for (const auto& roles : recording::roles_of(run).axes) {
      axes_.push_back(signals_of(run, roles));
      const std::size_t i = index_of(*axis_named(roles.axis));
      axes_.back().mass = machine.axes[i].effective_mass;
      require_motion(axes_.back());
    }
    if (specimen != nullptr) compute_forces(*specimen);
  }

  [[nodiscard]] std::vector<SignalFinding> all() {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      follow(i, "target", "command");
      follow(i, "command", "reference");
      follow(i, "reference", "reference_echo");
      follow(i, "reference_echo", "machine_displacement");
      follow(i, "machine_displacement", "displacement");
      follow(i, "displacement", "returned_displacement");
      check_acceleration(i);
      check_forces(i);
    }
    return findings_;
  }

 private:
  static void require_motion(const AxisSignals& axis) {
    const char* role = axis.has("target") ? "target" : "command";
    double squares = 0, count = 0;
    if (axis.has(role))
      for (const double x : axis.by_role.at(role)) {
        squares += x * x;
        ++count;
      }
    const double rms = count > 0 ? std::sqrt(squares / count) : 0;
    if (!(rms >= kLeastTarget))
      throw Error{
          fmt::format("signals of {}: the target moves {:.2g} m RMS, expected at least {} m",
                      axis.roles.axis, rms, kLeastTarget)};
  }

  // Displacements long and lat; zero along an axis without a signal.
  [[nodiscard]] std::array<Samples, 2> measured_motion() const {
    std::array<Samples, 2> motion;
    std::size_t count = 0;
    for (const auto& axis : axes_)
      if (axis.has("displacement")) {
        const Samples& measured = axis.by_role.at("displacement");
        motion[index_of(*axis_named(axis.roles.axis))] = measured;
        count = measured.size();
      }
    for (auto& axis : motion)
      if (axis.empty()) axis.assign(count, 0.0);
    return motion;
  }

  // Force of the assumed specimen under the measured displacements.
  void compute_forces(const sim::Bearing& specimen) {
    const auto motion = measured_motion();
    const std::size_t count = motion[0].size();
    sim::BearingRun bearing{specimen, kSample};
    std::array<Samples, 2> force;
    Eigen::Vector2d before = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector2d x{motion[0][k], motion[1][k]};
      const Eigen::Vector2d f = bearing.advance(x, (x - before) / kSample, specimen.axial_load);
      before = x;
      for (int i = 0; i < 2; ++i) force[static_cast<std::size_t>(i)].push_back(f[i]);
    }
    for (auto& axis : axes_)
      axis.by_role["model force"] = force[index_of(*axis_named(axis.roles.axis))];
  }

  void follow(std::size_t i, const std::string& before, const std::string& role) {
    if (axes_[i].has(before) && axes_[i].has(role))
      compare(i, role, before, signal_of(axes_[i].roles, before), kMotionGain);
  }

  void compare(std::size_t i, const std::string& role, const std::string& expected,
               const std::string& against, const std::array<double, 2>& gain) {
    const auto& found = axes_[i].by_role.at(role);
    const auto own = likeness(axes_[i].by_role.at(expected), found);
    SignalFinding finding;
    finding.axis = axes_[i].roles.axis;
    finding.role = role;
    finding.signal = is_axis_role(role) ? signal_of(axes_[i].roles, role) : role;
    finding.against = against;
    finding.gain = own.gain;
    finding.correlation = own.correlation;
    std::string other;
    if (axes_.size() == 2 && axes_[1 - i].has(expected)) {
      finding.crossed = likeness(axes_[1 - i].by_role.at(expected), found).correlation;
      other = axes_[1 - i].roles.axis;
    }
    finding.trouble = trouble_of(finding, gain, other);
    findings_.push_back(std::move(finding));
  }

  void check_acceleration(std::size_t i) {
    for (auto& axis : axes_) {
      if (!axis.has("machine_displacement")) return;
      axis.by_role["derivative"] = second_derivative(axis.by_role.at("machine_displacement"));
    }
    if (!axes_[i].has("machine_acceleration")) return;
    const Samples measured = axes_[i].by_role.at("machine_acceleration");
    axes_[i].by_role["machine_acceleration"] = triangular_mean(measured);
    compare(i, "machine_acceleration", "derivative", "second derivative of the displacement",
            kForceGain);
    axes_[i].by_role["machine_acceleration"] = measured;
  }

  void check_forces(std::size_t i) {
    if (!axes_[i].has("model force")) return;
    if (axes_[i].has("machine_force") && axes_[i].has("derivative")) {
      for (auto& axis : axes_) {
        Samples& expected = axis.by_role["table force"];
        expected = axis.by_role.at("model force");
        for (std::size_t k = 0; k < expected.size(); ++k)
          expected[k] += axis.mass * axis.by_role.at("derivative")[k];
      }
      compare(i, "machine_force", "table force", "force of the assumed specimen and inertia",
              kForceGain);
    }
    if (axes_[i].has("force"))
      compare(i, "force", "model force", "force of the assumed specimen", kForceGain);
    if (axes_[i].has("force") && axes_[i].has("returned_force"))
      compare(i, "returned_force", "force", axes_[i].roles.force, kMotionGain);
  }

  std::vector<AxisSignals> axes_;
  std::vector<SignalFinding> findings_;
};

}  // namespace

std::vector<SignalFinding> check_signals(const recording::Reader& run,
                                         const sim::TestMachine& machine,
                                         const sim::Bearing* specimen) {
  return Checks{run, machine, specimen}.all();
}

}  // namespace rths::commissioning

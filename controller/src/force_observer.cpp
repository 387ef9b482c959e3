// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/force_observer.hpp>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::controller {
namespace {

constexpr double kKilonewtonPerG = 1e3 / kStandardGravity;  // [kg]
constexpr double kKilonewtonSecondPerCentimetre = 1e5;      // [N·s/m]

constexpr double kSlowFraction =
    0.03;  // of a run's largest speed: below, the sign of a noisy velocity is uncertain

enum Term { kMass, kCoulomb, kViscous, kOffset, kTerms };

using Features = Eigen::Matrix<double, Eigen::Dynamic, kTerms>;
using Solution = Eigen::Matrix<double, kTerms, 1>;

double sign(double x) { return x > 0 ? 1.0 : (x < 0 ? -1.0 : 0.0); }

Eigen::RowVector4d features(double velocity, double acceleration, double exponent,
                            double rest_velocity) {
  const double direction = std::abs(velocity) < rest_velocity ? 0.0 : sign(velocity);
  const double speed = exponent == 1 ? std::abs(velocity) : std::pow(std::abs(velocity), exponent);
  return {acceleration, direction, speed * direction, 1.0};
}

// Least squares over the terms whose bits are set in `kept`; the others are zero.
std::optional<Solution> solve_subset(const Features& X, const Eigen::VectorXd& y, unsigned kept) {
  std::vector<int> columns;
  for (int term = 0; term < kTerms; ++term)
    if ((kept >> term & 1U) != 0) columns.push_back(term);
  Eigen::MatrixXd subset(X.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    subset.col(static_cast<Eigen::Index>(i)) = X.col(columns[i]);
  const Eigen::VectorXd found = maths::solve_least_squares(subset, y);
  Solution solution = Solution::Zero();
  for (std::size_t i = 0; i < columns.size(); ++i)
    solution[columns[i]] = found[static_cast<Eigen::Index>(i)];
  if (solution.head<kOffset>().minCoeff() < 0) return std::nullopt;
  return solution;
}

// Exact: three constraints have eight active sets, and all are tried. The offset is always free.
Solution constrained_least_squares(const Features& X, const Eigen::VectorXd& y) {
  Solution best = Solution::Zero();
  double best_error = std::numeric_limits<double>::infinity();
  for (unsigned kept = 0; kept < 8; ++kept) {
    const auto solution = solve_subset(X, y, kept | 1U << kOffset);
    if (!solution) continue;
    const double error = (y - X * *solution).squaredNorm();
    if (error < best_error) {
      best_error = error;
      best = *solution;
    }
  }
  return best;
}

std::vector<double> causal_velocity(std::span<const double> displacement, double period,
                                    int slope_length) {
  EndSlope slope{slope_length, period};
  std::vector<double> velocity;
  for (const double x : displacement) velocity.push_back(slope(x));
  return velocity;
}

MachineForce paper_axis(double mass_kn_per_g, double coulomb_kn, double viscous_kns_per_cm) {
  MachineForce force;
  force.effective_mass = mass_kn_per_g * kKilonewtonPerG;
  force.coulomb_friction = coulomb_kn * 1e3;
  force.viscous_friction = viscous_kns_per_cm * kKilonewtonSecondPerCentimetre;
  return force;
}

}  // namespace

double MachineForce::operator()(double velocity, double acceleration) const noexcept {
  const auto f = features(velocity, acceleration, exponent, rest_velocity);
  return effective_mass * f[kMass] + coulomb_friction * f[kCoulomb] +
         viscous_friction * f[kViscous] + offset;
}

MachineSetup unison_eqs_setup() {
  return {paper_axis(1111.79, 5.1, 0.00716), paper_axis(1145.77, 8.6, 0.0087)};
}

MachineSetup eps_setup() {
  return {paper_axis(982.97, 5.1, 0.00716), paper_axis(1001.38, 8.6, 0.0087)};
}

ForceObserver::ForceObserver(const MachineForce& machine, double period, int slope_length)
    : machine_{machine}, slope_{slope_length, period} {}

double ForceObserver::step(double displacement, double acceleration, double force) noexcept {
  velocity_ = slope_(displacement);
  machine_force_ = machine_(velocity_, acceleration);
  return force - machine_force_;
}

ForceIdentification identify_machine_force(std::span<const double> displacement,
                                           std::span<const double> acceleration,
                                           std::span<const double> force, double period,
                                           double exponent, int slope_length) {
  if (displacement.size() != force.size() || acceleration.size() != force.size())
    throw Error{"force identification: the measured signals differ in length"};
  const auto settling = static_cast<std::size_t>(slope_length);
  if (force.size() < 10 * settling) throw Error{"force identification: the run is too short"};

  ForceIdentification result;
  result.machine.exponent = exponent;
  const auto velocity = causal_velocity(displacement, period, slope_length);
  const double slow = kSlowFraction * maths::largest_magnitude(velocity);
  Features X(static_cast<Eigen::Index>(force.size()), kTerms);
  Eigen::VectorXd y(static_cast<Eigen::Index>(force.size()));
  Eigen::Index rows = 0;
  for (std::size_t i = settling; i < force.size(); ++i) {
    if (std::abs(velocity[i]) < slow) continue;
    X.row(rows) = features(velocity[i], acceleration[i], exponent, result.machine.rest_velocity);
    y[rows++] = force[i];
  }
  X.conservativeResize(rows, Eigen::NoChange);
  y.conservativeResize(rows);
  const Eigen::Matrix4d normal = X.transpose() * X;
  if (rows <= kTerms || normal.diagonal().minCoeff() <= 0)
    throw Error{"force identification: the run does not excite inertia and friction"};
  const Solution solution = constrained_least_squares(X, y);
  const Eigen::VectorXd residual = y - X * solution;
  const double variance = residual.squaredNorm() / static_cast<double>(rows - kTerms);
  const Eigen::Vector4d half_width =
      maths::kHalfWidth95 * (variance * normal.inverse()).diagonal().cwiseSqrt();

  result.machine.effective_mass = solution[kMass];
  result.machine.coulomb_friction = solution[kCoulomb];
  result.machine.viscous_friction = solution[kViscous];
  result.machine.offset = solution[kOffset];
  result.effective_mass_95 = half_width[kMass];
  result.coulomb_friction_95 = half_width[kCoulomb];
  result.viscous_friction_95 = half_width[kViscous];
  result.offset_95 = half_width[kOffset];
  result.residual_rms = std::sqrt(variance);
  return result;
}

}  // namespace rths::controller

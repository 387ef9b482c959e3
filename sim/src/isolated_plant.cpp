// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/isolated_plant.hpp>

#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Core>

#include <rths/core/axis.hpp>
#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDirections = 2;
constexpr double kElevationTolerance = 0.01;  // [m]

// Shear stick on a fixed base with unit storey stiffness.
MatrixXd unit_stiffness(int masses) {
  MatrixXd K = MatrixXd::Zero(masses, masses);
  for (int i = 0; i < masses; ++i) {
    K(i, i) += 1;
    if (i == 0) continue;
    K(i - 1, i - 1) += 1;
    K(i, i - 1) -= 1;
    K(i - 1, i) -= 1;
  }
  return K;
}

struct StickMatrices {
  MatrixXd K, C;
};

// C gives every mode the same damping ratio: C = M Φ diag(2ζω) Φᵀ M with ΦᵀMΦ = I.
StickMatrices stick_matrices(const VectorXd& m, double frequency, double damping_ratio) {
  MatrixXd K = unit_stiffness(static_cast<int>(m.size()));
  const MatrixXd M = m.asDiagonal();
  const double omega = 2 * std::numbers::pi * frequency;
  const double unit_eigenvalue = maths::generalized_modes(K, M).values[0];
  K *= omega * omega / unit_eigenvalue;
  const maths::Modes modes = maths::generalized_modes(K, M);
  const VectorXd c = 2 * damping_ratio * modes.values.cwiseSqrt();
  const MatrixXd MPhi = M * modes.vectors;
  return {K, MPhi * c.asDiagonal() * MPhi.transpose()};
}

// Adds a stick on the basemat: its forces depend on motion relative to the basemat.
void add_relative(MatrixXd& global, const MatrixXd& stick, int first, int base) {
  const auto n = stick.rows();
  const VectorXd rigid = VectorXd::Ones(n);
  const VectorXd row = stick * rigid;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index gi = first + kDirections * i;
    for (Eigen::Index j = 0; j < n; ++j) global(gi, first + kDirections * j) += stick(i, j);
    global(gi, base) -= row[i];
    global(base, gi) -= row[i];
  }
  global(base, base) += rigid.dot(row);
}

constexpr Require kRequirePlant{"plant"};

void require_ratio(std::string_view name, double found) {
  kRequirePlant(found >= 0 && found < 1, name, found, "0 or more, below 1");
}

void check(const Stick& stick) {
  if (stick.masses.empty() || stick.masses.size() != stick.elevations.size())
    throw Error{
        fmt::format("plant: stick '{}' has {} masses and {} elevations, expected one or more "
                    "masses, each with its elevation",
                    stick.name, stick.masses.size(), stick.elevations.size())};
  const std::string of_stick = " of stick '" + stick.name + "'";
  for (const double mass : stick.masses) kRequirePlant.positive("a mass" + of_stick, mass);
  kRequirePlant.positive("the frequency along long" + of_stick, stick.frequency_long);
  kRequirePlant.positive("the frequency along lat" + of_stick, stick.frequency_lat);
}

void check(const IsolatedPlant& plant) {
  kRequirePlant.positive("the mass of the basemat", plant.basemat_mass);
  if (plant.sticks.empty()) throw Error{"plant: has no stick, expected at least one"};
  kRequirePlant(plant.bearings >= 1, "the number of bearings", plant.bearings, "at least 1");
  require_ratio("the damping ratio", plant.damping_ratio);
  kRequirePlant.positive("the vertical frequency", plant.vertical_frequency);
  require_ratio("the vertical damping", plant.vertical_damping);
  const auto stands_under = [](Axis axis, double at, double side) {
    kRequirePlant(std::abs(at) <= side / 2,
                  fmt::format("the tested bearing's place along {}", name_of(axis)), at,
                  fmt::format("a place under the basemat, {:g} to {:g} m", -side / 2, side / 2));
  };
  stands_under(Axis::Long, plant.bearing_long, plant.plan_long);
  stands_under(Axis::Lat, plant.bearing_lat, plant.plan_lat);
  for (const auto& stick : plant.sticks) check(stick);
}

// Compression of the tested bearing per force at height 1 m. On a rigid basemat it grows with the
// distance from the centre; n bearings on a side L have the second moment n L²/12. @returns [1/m]
double compression_per_moment(const IsolatedPlant& plant, int direction) {
  const double side = direction == 0 ? plant.plan_long : plant.plan_lat;
  const double place = direction == 0 ? plant.bearing_long : plant.bearing_lat;
  return 12 * place / (plant.bearings * side * side);
}

int floor_at(const Stick& stick, double elevation, int first) {
  for (std::size_t i = 0; i < stick.elevations.size(); ++i)
    if (std::abs(stick.elevations[i] - elevation) < kElevationTolerance)
      return first + kDirections * static_cast<int>(i);
  throw Error{fmt::format("plant: stick '{}' has no mass at the spectrum elevation of {} m",
                          stick.name, elevation)};
}

}  // namespace

double weight_per_bearing(const IsolatedPlant& plant) {
  double mass = plant.basemat_mass;
  for (const auto& stick : plant.sticks)
    mass += std::accumulate(stick.masses.begin(), stick.masses.end(), 0.0);
  return mass * kStandardGravity / plant.bearings;
}

PlantMatrices assemble(const IsolatedPlant& plant) {
  check(plant);
  int dofs = kDirections;
  for (const auto& stick : plant.sticks)
    dofs += kDirections * static_cast<int>(stick.masses.size());

  PlantMatrices matrices;
  matrices.M = MatrixXd::Zero(dofs, dofs);
  matrices.C = MatrixXd::Zero(dofs, dofs);
  matrices.K = MatrixXd::Zero(dofs, dofs);
  matrices.iota = MatrixXd::Zero(dofs, kDirections);
  matrices.bearings = plant.bearings;
  matrices.mass_per_bearing = weight_per_bearing(plant) / kStandardGravity;
  matrices.vertical_frequency = plant.vertical_frequency;
  matrices.vertical_damping = plant.vertical_damping;
  matrices.M(0, 0) = matrices.M(1, 1) = plant.basemat_mass;
  matrices.overturning = VectorXd::Zero(dofs);
  for (int i = 0; i < dofs; ++i) matrices.iota(i, i % kDirections) = 1;

  int first = kDirections;
  for (const auto& stick : plant.sticks) {
    const auto n = static_cast<Eigen::Index>(stick.masses.size());
    const VectorXd m = Eigen::Map<const VectorXd>(stick.masses.data(), n);
    for (int direction = 0; direction < kDirections; ++direction) {
      const double frequency = direction == 0 ? stick.frequency_long : stick.frequency_lat;
      const auto stick_direction = stick_matrices(m, frequency, plant.damping_ratio);
      const double per_moment = compression_per_moment(plant, direction);
      add_relative(matrices.K, stick_direction.K, first + direction, direction);
      add_relative(matrices.C, stick_direction.C, first + direction, direction);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index dof = first + direction + kDirections * i;
        matrices.M(dof, dof) = m[i];
        matrices.overturning[dof] = per_moment * stick.elevations[static_cast<std::size_t>(i)];
      }
    }
    matrices.floor_names.push_back(stick.name);
    matrices.floors.push_back(floor_at(stick, plant.spectrum_elevation, first));
    first += kDirections * static_cast<int>(n);
  }
  return matrices;
}

PlantMatrices PlantMatrices::fixed_base() const {
  const int n = dofs() - kDirections;
  PlantMatrices fixed;
  fixed.M = M.bottomRightCorner(n, n);
  fixed.C = C.bottomRightCorner(n, n);
  fixed.K = K.bottomRightCorner(n, n);
  fixed.iota = iota.bottomRows(n);
  fixed.floor_names = floor_names;
  for (const int floor : floors) fixed.floors.push_back(floor - kDirections);
  return fixed;
}

IsolatedPlant example_plant() {
  IsolatedPlant plant;
  plant.basemat_mass = 145e6;
  plant.sticks = {
      {"containment", {16e6, 16e6, 16e6, 14e6, 10e6}, {12.0, 24.0, 36.0, 47.5, 60.0}, 4.4, 4.6},
      {"internal structure", {22e6, 20e6, 18e6, 12e6}, {10.0, 22.0, 35.0, 47.5}, 5.9, 6.3},
      {"auxiliary building", {60e6, 50e6, 45e6, 36e6}, {12.0, 24.0, 36.0, 47.5}, 7.6, 7.6}};
  return plant;
}

}  // namespace rths::sim

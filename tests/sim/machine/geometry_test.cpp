// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <rths/sim/machine/geometry.hpp>

#include "srmd_file.hpp"

namespace rths::sim::machine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Pose kTilted{{0.9, -0.4, 0.05}, {0.02, -0.03, 0.015}};

// The coordinates of all actuators at a pose.
std::vector<Coordinate> coordinates(const PlatenMachine& m, const Pose& pose) {
  std::vector<Coordinate> found;
  const Matrix3d R = pose.rotation();
  for (std::size_t i = 0; i < kHorizontal; ++i)
    found.push_back(actuator_length(m.base[i], R * m.swivel[i], pose.position));
  for (const auto& foot : m.foot) found.push_back(pad_height(foot, m.depth, R, pose.position));
  return found;
}

// Moves a pose by a small linear and angular displacement, both in the floor's axes.
Pose moved(const Pose& pose, const Vector6& by) {
  const Vector3d body = pose.rotation().transpose() * by.tail<3>();
  return {pose.position + by.head<3>(), pose.angles + angle_rates(pose.angles, body)};
}

TEST(PlatenGeometry, RotatesAsEigenDoes) {
  const Matrix3d expected =
      (Eigen::AngleAxisd{0.3, Vector3d::UnitZ()} * Eigen::AngleAxisd{-0.2, Vector3d::UnitY()} *
       Eigen::AngleAxisd{0.1, Vector3d::UnitX()})
          .toRotationMatrix();

  EXPECT_LT((Pose{Vector3d::Zero(), {0.1, -0.2, 0.3}}.rotation() - expected).norm(), 1e-15);
}

// Virtual work: the rates of all coordinates are their jacobians times the motion. The central
// difference over ±1e-6 is exact to 1e-12 and rounding of 1e-10.
TEST(PlatenGeometry, HasJacobiansThatMatchDifferences) {
  const PlatenMachine m = test::srmd_machine_file();
  for (int axis = 0; axis < 6; ++axis) {
    Vector6 by = Vector6::Zero();
    by[axis] = 1e-6;
    const auto at = coordinates(m, kTilted);
    const auto ahead = coordinates(m, moved(kTilted, by));
    const auto behind = coordinates(m, moved(kTilted, -by));
    for (std::size_t i = 0; i < at.size(); ++i)
      EXPECT_NEAR((ahead[i].value - behind[i].value) / 2e-6, at[i].jacobian[axis], 1e-9)
          << "actuator " << i << ", axis " << axis;
  }
}

// At mid-stroke the actuators' largest forces are the forces of Table 1.
TEST(PlatenGeometry, TransmitsTheForcesOfTableOne) {
  const PlatenMachine m = test::srmd_machine_file();
  const auto at = coordinates(m, Pose{});
  Vector6 total = Vector6::Zero();
  for (std::size_t i = 0; i < at.size(); ++i)
    total += m.supply.pressure * m.actuator(i).piston_area * at[i].jacobian;

  for (int axis = 0; axis < 3; ++axis)  // areas have three digits
    EXPECT_NEAR(total[axis], m.limits.force[axis], 2e-3 * m.limits.force[axis]);
  // The long pair is symmetric; the lat pair is, too.
  for (int axis = 3; axis < 6; ++axis) EXPECT_NEAR(total[axis], 0, 1e-6);
}

TEST(PlatenGeometry, LeavesAForceOnALevelPadVertical) {
  const Pose pose{{0.5, 0.2, 0.03}, {0, 0, 0.02}};
  const Coordinate pad = pad_height({1.1, 0.9}, 0.5, pose.rotation(), pose.position);

  EXPECT_NEAR(pad.value, 0.03 - 0.5, 1e-15);
  EXPECT_LT((pad.jacobian.head<3>() - Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_NEAR(pad.jacobian[3], 0.9 - 0.2, 1e-15);     // roll: the arm along lat
  EXPECT_NEAR(pad.jacobian[4], -(1.1 - 0.5), 1e-15);  // pitch: minus the arm along long
}

TEST(PlatenGeometry, KeepsAllActuatorsInTheirStrokesInTheWorkspace) {
  const PlatenMachine m = test::srmd_machine_file();
  const auto middle = coordinates(m, Pose{});
  const double r = m.limits.rotation;
  for (unsigned corner = 0; corner < 64; ++corner) {
    const auto sign = [&](unsigned bit) { return (corner >> bit & 1U) != 0 ? 1.0 : -1.0; };
    const Vector3d& s = m.limits.stroke;
    // Vertically, rotation and translation share the stroke.
    const Pose pose{{sign(0) * s[0], sign(1) * s[1], sign(2) * s[2] / 4},
                    {sign(3) * r, sign(4) * r, sign(5) * r}};
    const auto at = coordinates(m, pose);
    for (std::size_t i = 0; i < kHorizontal; ++i)
      EXPECT_LT(std::abs(at[i].value - middle[i].value), m.actuator(i).stroke) << corner;
  }
}

// Closed form: two long actuators of stiffness k, each 1/V1 + 1/V2 at mid-stroke, in parallel.
TEST(PlatenMachine, HasTheNaturalFrequenciesOfItsOilColumns) {
  PlatenMachine m = test::srmd_machine_file();
  const auto translational = [&](const Actuator& a, double mass, int count) {
    const double half = a.stroke + a.dead_length;
    const double chambers = a.single_acting ? 1 : 2;
    return std::sqrt(count * chambers * m.supply.bulk_modulus * a.piston_area / half / mass) /
           (2 * M_PI);
  };
  m.outriggers.stiffness = 0;
  const Vector6 found = natural_frequencies(m);
  const auto has = [&](double f) { return (found.array() - f).abs().minCoeff() < 1e-6 * f; };

  EXPECT_TRUE(has(translational(m.vertical, m.mass[2], 4))) << found.transpose();
  EXPECT_TRUE(has(translational(m.along_long, m.mass[0], 2))) << found.transpose();
  EXPECT_TRUE(has(translational(m.along_lat, m.mass[1], 2))) << found.transpose();
  // Yaw: the same oil columns at their arms.
  const auto stiffness = [&](const Actuator& a) { return oil_stiffness(a, m.supply, 0); };
  const double yaw = 2 * (stiffness(m.along_long) * 1.2 * 1.2 + stiffness(m.along_lat) * 1.5 * 1.5);
  EXPECT_TRUE(has(std::sqrt(yaw / m.inertia[2]) / (2 * M_PI))) << found.transpose();
  // The mode beside the band of the floor spectra.
  EXPECT_GT(found[0], 10);
  EXPECT_LT(found[1], 15);
}

}  // namespace
}  // namespace rths::sim::machine

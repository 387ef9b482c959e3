// SPDX-License-Identifier: Apache-2.0
//
// A bearing that lifts off pulls only with a share of its stiffness.
#include <gtest/gtest.h>

#include "plant/drive.hpp"
#include "plant/plants.hpp"

namespace rths::plant {
namespace {

using test::large_basis;
using test::large_plant;
using test::lead_rubber;

constexpr double kWeight = 1e6;        // [N]
constexpr double kDampingTime = 6e-4;  // [s]

class TwoBearings : public testing::Test {
 protected:
  // Raises the second bearing above equilibrium [m]. @returns its upward force on the structure [N]
  double raised(double up) {
    MatrixXd motion = MatrixXd::Zero(6, 2);
    motion(5, 0) = up;
    VectorXd correction = VectorXd::Zero(6), force = VectorXd::Zero(6);
    field_.advance(motion, 0, correction);
    field_.forces(motion, correction, force);
    return kWeight - force[5];
  }
  [[nodiscard]] double spring_force(double up) const {
    return kWeight - bearings_.vertical_stiffness * up;
  }

  BearingSet bearings_ = BearingSet::all_of(lead_rubber(), 2);
  BearingField field_{bearings_, VectorXd::Constant(2, kWeight), 0.01, kDampingTime};
};

TEST_F(TwoBearings, CarryAsLinearSpringsInCompression) {
  for (const double up : {-1e-3, 0.0, 0.9 * kWeight / 8e9})
    EXPECT_NEAR(raised(up), spring_force(up), 1e-9 * kWeight);
  EXPECT_EQ(field_.lifted(), 0U);
}

TEST_F(TwoBearings, PullWithTheirShareOfTheStiffnessOnceLifted) {
  const double up = 5 * kWeight / bearings_.vertical_stiffness;

  EXPECT_NEAR(raised(up), bearings_.tension_share * spring_force(up), 1e-9 * kWeight);
  EXPECT_LT(raised(up), 0);
  EXPECT_EQ(field_.lifted(), 1U);
  EXPECT_NEAR(field_.least_load(), spring_force(up), 1e-9 * kWeight);
}

TEST_F(TwoBearings, StayCountedAfterTheyHaveComeDown) {
  raised(5 * kWeight / bearings_.vertical_stiffness);
  raised(0);

  EXPECT_EQ(field_.lifted(), 1U);
}

TEST_F(TwoBearings, StopMovingDampedOnceTheyCarryNothing) {
  MatrixXd motion = MatrixXd::Zero(6, 2);
  motion(5, 0) = 0.9 * kWeight / bearings_.vertical_stiffness;
  motion(5, 1) = 1;  // its dashpot would pull with 4.8 MN
  VectorXd correction = VectorXd::Zero(6);

  field_.advance(motion, 0, correction);

  const double carried = 0.1 * kWeight - kDampingTime * bearings_.vertical_stiffness * motion(5, 1);
  EXPECT_NEAR(correction[5], carried * (1 - bearings_.tension_share), 1e-9 * kWeight);
  EXPECT_EQ(field_.lifted(), 0U);
}

std::size_t lifted_under(double scale) {
  constexpr double kStep = 0.005, kLength = 6;  // [s]
  const auto& [mesh, structure, bearings] = large_plant();
  PlantSettings settings;
  settings.time_step = kStep;
  const auto plant =
      make_reduced(large_basis(), bearings, test::petrolia(scale), structure.floors, settings);
  const auto response = test::drive(*plant, lead_rubber(), kStep, kLength);
  EXPECT_TRUE(response.floors.allFinite());
  return plant->bearings().lifted();
}

TEST(LiftOff, IsThatOfBearingsWithLittleLoadUnderStrongMotion) {
  EXPECT_EQ(lifted_under(0.1), 0U);
  const std::size_t lifted = lifted_under(3);
  EXPECT_GT(lifted, 0U);
  EXPECT_LT(lifted, 486U);
}

TEST(LiftOff, IsTheSameInTheReducedAndTheFullPlant) {
  constexpr double kScale = 2, kLength = 5;  // [s]
  const auto& [mesh, structure, bearings] = large_plant();
  PlantSettings settings;
  settings.time_step = 0.002;
  const auto motion = test::petrolia(kScale);
  const auto reduced = make_reduced(large_basis(), bearings, motion, structure.floors, settings);
  const auto full = make_full(structure, bearings, motion, settings);

  const auto found = test::drive(*reduced, lead_rubber(), settings.time_step, kLength),
             expected = test::drive(*full, lead_rubber(), settings.time_step, kLength);

  const double difference = test::difference(found.tested, expected.tested);
  EXPECT_GT(full->bearings().lifted(), 0U);
  EXPECT_LT(difference, 0.05);
  RecordProperty("tested_percent", std::to_string(difference));
  RecordProperty("lifted", std::to_string(full->bearings().lifted()));
}

}  // namespace
}  // namespace rths::plant

// SPDX-License-Identifier: Apache-2.0
// Hysteresis laws against their closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

using test_support::Stepper;
using test_support::Values;

constexpr double kStrength = 1e6, kYield = 3e-3;

Stepper rule(const std::string& kind, Values more = {}) {
  Values values{{"characteristic_strength", kStrength}, {"yield_displacement", kYield}};
  values.insert(values.end(), more.begin(), more.end());
  return Stepper{{{kind, "", values}}, 1e-3};
}

// Work of the cycle from amplitude to −amplitude and back, after loading from rest.
double work_of_cycle(Stepper& stepper, double amplitude, int steps) {
  double work = 0, last = stepper.walk(0, amplitude, steps).force[0];
  for (const double end : {-amplitude, amplitude}) {
    for (int i = 1; i <= steps; ++i) {
      const double force = stepper.to(-end + 2 * end * i / steps).force[0];
      work += 0.5 * (force + last) * 2 * end / steps;
      last = force;
    }
  }
  return work;
}

TEST(BoucWen, IsATanhWhenBetaAndGammaAreEqual) {
  auto bearing = rule("bouc_wen");
  for (int i = 1; i <= 100; ++i) {
    const double u = 1e-4 * i;
    EXPECT_NEAR(bearing.to(u).force[0], kStrength * std::tanh(u / kYield), 1e-4 * kStrength);
  }
}

// Unloading is a straight line to z = 0 (sgn cancels gamma), then a tanh.
TEST(BoucWen, DissipatesTheAreaOfItsLoop) {
  auto bearing = rule("bouc_wen");
  const double a = 10 * kYield;

  const double work = work_of_cycle(bearing, a, 4000);

  const double half = kYield * (std::log(std::cosh((2 * a - kYield) / kYield)) - 0.5);
  EXPECT_NEAR(work, 2 * kStrength * half, 1e-4 * work);
}

// Midpoint in steps of 1/2000 of the yield displacement: its error is below 1e-6.
TEST(BoucWen, AgreesWithAFineIntegrationForAnyShape) {
  const double beta = 0.7, eta = 3.5;
  auto bearing = rule("bouc_wen", {{"beta", beta}, {"eta", eta}});
  double z = 0, u = 0;
  const auto rate = [&](double at, double direction) {
    const double sign = at * direction > 0 ? 1 : -1;
    return (1 - std::pow(std::abs(at), eta) * (1 - beta + beta * sign)) * direction / kYield;
  };
  for (int i = 1; i <= 400; ++i) {
    const double next = 4 * kYield * std::sin(0.05 * i);
    const int steps = 400;
    const double du = (next - u) / steps, direction = du > 0 ? 1 : -1;
    for (int k = 0; k < steps; ++k) {
      const double middle = z + 0.5 * std::abs(du) * rate(z, direction);
      z += std::abs(du) * rate(middle, direction);
    }
    u = next;
    ASSERT_NEAR(bearing.to(u).force[0], kStrength * z, 2e-4 * kStrength) << "step " << i;
  }
}

TEST(BoucWen, HasIndependentAxesWithoutCoupling) {
  auto both = rule("bouc_wen", {{"coupling", 0}});
  auto along = rule("bouc_wen"), across = rule("bouc_wen");
  for (int i = 1; i <= 300; ++i) {
    const double x = 0.01 * std::sin(0.1 * i), y = 0.01 * std::sin(0.07 * i);
    const auto q = both.to(x, y);
    // The substeps depend on the motion of both axes; the error of either is below 1e-4.
    ASSERT_NEAR(q.force[0], along.to(x).force[0], 2e-4 * kStrength);
    ASSERT_NEAR(q.force[1], across.to(y).force[0], 2e-4 * kStrength);
  }
}

TEST(BoucWenNagarajaiah, IsBoucWenAlongALineButNotAroundACircle) {
  auto nagarajaiah = rule("bouc_wen_nagarajaiah", {{"beta", 0.9}});
  auto rotating = rule("bouc_wen", {{"beta", 0.9}});
  for (int i = 1; i <= 200; ++i) {
    const double u = 0.01 * std::sin(0.1 * i);
    ASSERT_NEAR(nagarajaiah.to(u, 0.3 * u).force[0], rotating.to(u, 0.3 * u).force[0], 1e-9);
  }
  double largest = 0;
  for (int i = 1; i <= 200; ++i) {
    const double x = 0.01 * std::sin(0.1 * i), y = 0.01 * (1 - std::cos(0.1 * i));
    largest =
        std::max(largest, std::abs(nagarajaiah.to(x, y).force[0] - rotating.to(x, y).force[0]));
  }
  EXPECT_GT(largest, 0.01 * kStrength);
}

// Along a line dz (1/(1-z²) u_y + a f(z)) = du: u = u_y artanh z + a erf(z/(σ√2)).
TEST(BoucWenSlip, FollowsItsBackboneCurve) {
  const double slip = 0.01, sigma = 0.2;
  auto device = rule("bouc_wen_slip", {{"slip_length", slip}, {"slip_width", sigma}});
  for (int i = 1; i <= 250; ++i) {
    const double u = 1e-4 * i;
    const double z = device.to(u).force[0] / kStrength;
    if (z > 0.999) break;  // artanh is too steep there
    const double expected = kYield * std::atanh(z) + slip * std::erf(z / (sigma * std::sqrt(2)));
    EXPECT_NEAR(expected, u, 1e-4 * u) << z;
  }
}

TEST(Bilinear, DissipatesTheAreaOfItsParallelogram) {
  auto device = rule("bilinear");
  const double a = 5 * kYield;

  EXPECT_NEAR(device.walk(0, 0.5 * kYield, 1).force[0], 0.5 * kStrength, 1e-9);
  device.walk(0.5 * kYield, 0, 1);
  // The corners are multiples of kYield/100.
  EXPECT_NEAR(work_of_cycle(device, a, 1000), 4 * kStrength * (a - kYield), 1e-9 * kStrength);
}

TEST(Bilinear, TurnsItsForceIntoTheDirectionOfSliding) {
  auto device = rule("bilinear");
  device.to(10 * kYield, 0);
  Quantities<double> q;
  for (int i = 1; i <= 100; ++i) q = device.to(10 * kYield, 0.2 * kYield * i);

  EXPECT_NEAR(std::hypot(q.force[0], q.force[1]), kStrength, 1e-9 * kStrength);
  EXPECT_NEAR(q.force[1], kStrength, 1e-6 * kStrength);
}

class IwanDevice : public testing::Test {
 protected:
  static Stepper device() {
    return Stepper{{{"iwan",
                     "",
                     {{"post_yield_stiffness", 4e6},
                      {"reach", 0.1},
                      {"strength_1", 1e5},
                      {"strength_2", 3e5},
                      {"strength_3", 3e5},
                      {"strength_4", 2e5},
                      {"strength_5", 1e5},
                      {"strength_6", 5e4}}}},
                   1e-3};
  }
  static double backbone(double u) { return device().to(u).force[0]; }
  static constexpr double kRoundOff = 1e-6;  // [N], of 1e6
};

TEST_F(IwanDevice, CarriesItsWholeStrengthBeyondItsReach) {
  EXPECT_NEAR(backbone(0.1), 1.05e6 + 4e5, kRoundOff);
  EXPECT_NEAR(backbone(0.2), 1.05e6 + 8e5, kRoundOff);
}

// The sliders of one knot are at r = reach·10^(j/10 − 2) with hat-shaped shares, 4 from knot to
// knot.
TEST_F(IwanDevice, FollowsTheSplineOfOneKnot) {
  Stepper device{{{"iwan", "", {{"reach", 0.1}, {"strength_3", 1e6}}}}, 1e-3};
  for (const double u : {1e-4, 1e-3, 5e-3, 7e-3, 1e-2, 5e-2}) {
    double expected = 0;
    for (int j = -3; j <= 3; ++j) {
      const double r = 0.1 * std::pow(10, (8 + j) / 10.0 - 2);
      expected += 1e6 * (1 - std::abs(j) / 4.0) / 4 * std::min(u / r, 1.0);
    }
    EXPECT_NEAR(device.to(u).force[0], expected, kRoundOff) << u;
  }
}

TEST_F(IwanDevice, ObeysMasingsRule) {
  auto device = IwanDevice::device();
  const double turn = 0.03;
  const double at_turn = device.walk(0, turn, 7).force[0];
  for (int i = 1; i <= 60; ++i) {
    const double u = turn - 1e-3 * i;
    EXPECT_NEAR(device.to(u).force[0], at_turn - 2 * backbone((turn - u) / 2), kRoundOff) << u;
  }
  const double back = device.to(-turn).force[0];
  EXPECT_NEAR(back, -at_turn, kRoundOff);
  EXPECT_NEAR(device.to(0.01).force[0], back + 2 * backbone((turn + 0.01) / 2), kRoundOff);
}

TEST_F(IwanDevice, ClosesASmallLoopAndForgetsIt) {
  auto device = IwanDevice::device();
  const double before = device.walk(0, 0.02, 5).force[0];
  device.walk(0.02, 0.012, 5);

  EXPECT_NEAR(device.walk(0.012, 0.02, 5).force[0], before, kRoundOff);
  EXPECT_NEAR(device.to(0.05).force[0], backbone(0.05), kRoundOff);
}

TEST(HysteresisShape, ApproachesItsForcesExponentially) {
  const double length = 1.2e-3;
  Stepper device{{{"hysteresis_shape", "", {{"length", length}, {"force_2", 1e5}}}}, 1e-3};

  const double second = length * 4 / 1.2;
  EXPECT_NEAR(device.walk(0, 2 * second, 3).force[0], 1e5 * (1 - std::exp(-2)), 1e-6);
  EXPECT_NEAR(device.walk(2 * second, second, 9).force[0],
              1e5 * (-1 + (2 - std::exp(-2)) * std::exp(-1)), 1e-6);
}

// Far beyond yield each step dissipates Q du; W lags by one step.
TEST(Degradation, LowersStrengthWithDissipatedWork) {
  const double loss = 1e-5;
  Stepper device{
      {{"bilinear", "", {{"characteristic_strength", kStrength}, {"yield_displacement", 1e-6}}},
       {"degradation", "", {{"strength_loss", loss}}}},
      1e-3};

  const double force = device.walk(0, 1, 10'000).force[0];

  // dW = Q/(1 + d W) du:  W + d W²/2 = Q u,  F = Q/√(1 + 2 d Q u).
  EXPECT_NEAR(force, kStrength / std::sqrt(1 + 2 * loss * kStrength), 1e-3 * force);
}

}  // namespace
}  // namespace rths::sim

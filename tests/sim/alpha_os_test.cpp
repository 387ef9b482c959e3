// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/sim/alpha_os.hpp>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd scalar(double value) { return MatrixXd::Constant(1, 1, value); }

// Largest error against the closed form of a damped oscillator under a step load.
double error_of_step_response(double dt, double alpha) {
  const double m = 2;
  const double omega = 2 * std::numbers::pi * 1.5;
  const double zeta = 0.05;
  const double k = m * omega * omega;
  AlphaOs integrator{scalar(m), scalar(2 * zeta * omega * m), scalar(k), dt, alpha};
  const double load = 100;
  const double omega_d = omega * std::sqrt(1 - zeta * zeta);
  double worst = 0;
  // The load is a ramp over the first step, which shifts the response by half a step.
  for (int i = 1; i * dt <= 2; ++i) {
    const VectorXd u = integrator.predict();
    integrator.correct(k * u, VectorXd::Constant(1, load));
    const double t = (i - 0.5) * dt;
    const double exact =
        load / k *
        (1 - std::exp(-zeta * omega * t) *
                 (std::cos(omega_d * t) + zeta * omega / omega_d * std::sin(omega_d * t)));
    worst = std::max(worst, std::abs(integrator.displacement()[0] - exact));
  }
  return worst / (load / k);
}

TEST(AlphaOs, ConvergesWithTheSquareOfTheStep) {
  for (const double alpha : {0.0, -0.05}) {
    const double coarse = error_of_step_response(0.01, alpha);
    const double fine = error_of_step_response(0.005, alpha);

    EXPECT_LT(coarse, 0.02);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.4);  // second order
  }
}

TEST(AlphaOs, KeepsTheEnergyOfAnUndampedOscillatorWithoutAlpha) {
  const double omega = 2 * std::numbers::pi;
  AlphaOs integrator{scalar(1), scalar(0), scalar(omega * omega), 0.05, 0};
  // One step of load starts the motion.
  double load = 1;
  double early = 0;
  double late = 0;
  for (int i = 0; i < 20'000; ++i) {
    const VectorXd u = integrator.predict();
    integrator.correct(omega * omega * u, VectorXd::Constant(1, load));
    load = 0;
    const double size = std::abs(integrator.displacement()[0]);
    if (i < 1000) early = std::max(early, size);
    if (i > 19'000) late = std::max(late, size);
  }

  // Samples miss the peaks of a sine by varying phases.
  EXPECT_NEAR(late / early, 1, 1e-4);
}

TEST(AlphaOs, DampsHighFrequenciesWithAlpha) {
  const double omega = 2 * std::numbers::pi * 40;
  AlphaOs integrator{scalar(1), scalar(0), scalar(omega * omega), 0.01, -0.2};
  double load = 1;
  double early = 0;
  double late = 0;
  for (int i = 0; i < 400; ++i) {
    const VectorXd u = integrator.predict();
    integrator.correct(omega * omega * u, VectorXd::Constant(1, load));
    load = 0;
    (i < 50 ? early : late) = std::max(i < 50    ? early
                                       : i > 350 ? late
                                                 : 0.0,
                                       std::abs(integrator.displacement()[0]));
  }

  EXPECT_LT(late, 0.2 * early);
}

// Unconditionally stable while the specimen is not stiffer than K_I: here it has a tenth of K_I.
TEST(AlphaOs, StaysBoundedForASofteningSpecimenAtAnyStep) {
  const double k = 1e6;
  for (const double dt : {0.01, 0.1, 1.0}) {
    AlphaOs integrator{scalar(100), scalar(0), scalar(k), dt, -0.05};
    double load = 1000;
    double largest = 0;
    for (int i = 0; i < 5000; ++i) {
      const VectorXd u = integrator.predict();
      integrator.correct(0.1 * k * u, VectorXd::Constant(1, load));
      load = 0;
      largest = std::max(largest, std::abs(integrator.displacement()[0]));
    }
    EXPECT_LT(largest, 1000 / (0.1 * k) * 3);
  }
}

TEST(AlphaOs, RestsInStaticEquilibriumUnderASlowLoad) {
  const double k = 1e6;
  AlphaOs integrator{scalar(1000), scalar(2e4), scalar(k), 0.01, -0.05};
  for (int i = 1; i <= 20'000; ++i) {
    const VectorXd u = integrator.predict();
    integrator.correct(k * u, VectorXd::Constant(1, 5000 * std::min(1.0, i / 10'000.0)));
  }

  EXPECT_NEAR(integrator.displacement()[0], 5000 / k, 1e-9);
}

TEST(AlphaOs, ResetReturnsToRest) {
  AlphaOs integrator{scalar(1), scalar(0), scalar(100), 0.01, 0};
  static_cast<void>(integrator.predict());
  integrator.correct(VectorXd::Zero(1), VectorXd::Ones(1));

  integrator.reset();

  EXPECT_EQ(integrator.displacement()[0], 0);
  EXPECT_EQ(integrator.predict()[0], 0);
}

TEST(AlphaOs, RefusesInvalidMatricesAndSettings) {
  EXPECT_NE(test::error_of([] { AlphaOs(scalar(1), scalar(0), scalar(1), 0, 0); }), "");
  EXPECT_NE(test::error_of([] { AlphaOs(scalar(1), scalar(0), scalar(1), 0.01, 0.1); }), "");
  EXPECT_NE(test::error_of([] { AlphaOs(scalar(-1), scalar(0), scalar(1), 0.01, 0); }), "");
  EXPECT_NE(test::error_of([] { AlphaOs(scalar(1), MatrixXd::Zero(2, 2), scalar(1), 0.01, 0); }),
            "");
}

TEST(AlphaOs, StepsInRealTime) {
  const int n = 28;
  AlphaOs integrator{MatrixXd::Identity(n, n), MatrixXd::Zero(n, n), MatrixXd::Identity(n, n), 0.01,
                     -0.05};
  const VectorXd force = VectorXd::Ones(n);
  EXPECT_REALTIME(integrator.predict());
  EXPECT_REALTIME(integrator.correct(force, force));
}

}  // namespace
}  // namespace rths::sim

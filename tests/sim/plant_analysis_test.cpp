// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/plant_analysis.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <rths/loop/numerical_response.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

/// A sine with a period of one second in the long direction.
GroundMotion sine_motion() {
  GroundMotion motion;
  motion.time_step = 0.005;
  for (int i = 0; i < 4000; ++i) {
    motion.long_acceleration.push_back(std::sin(2 * std::numbers::pi * i * motion.time_step));
    motion.lat_acceleration.push_back(0);
  }
  return motion;
}

// With a linear bearing the analysis must agree with the steady state of the complex equations.
TEST(PlantAnalysis, AgreesWithTheFrequencyResponseOfTheLinearPlant) {
  const PlantMatrices plant = assemble(example_plant());
  const double k = 4.238e6;
  const double dt = 0.001;
  PlantMatrices damped = plant;
  // The isolation mode itself is undamped; a dashpot at the base makes it decay.
  damped.C(0, 0) += 0.6 * std::sqrt(486 * k * 480e6);
  PlantAnalysis analysis{damped, sine_motion(), k, dt, 0};
  const double omega = 2 * std::numbers::pi;
  double largest = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector2d u = analysis.predict();
    analysis.correct(k * u);
    if (i > 18'000) largest = std::max(largest, std::abs(analysis.base_displacement()[0]));
  }

  const std::complex<double> j{0, 1};
  Eigen::MatrixXd stiffness = damped.K;
  stiffness.topLeftCorner(2, 2).diagonal().array() += damped.bearings * k;
  const Eigen::MatrixXcd dynamic = (stiffness - omega * omega * damped.M) + j * omega * damped.C;
  const Eigen::VectorXcd response =
      dynamic.partialPivLu().solve(Eigen::VectorXcd(-damped.M * damped.iota.col(0)));
  EXPECT_NEAR(largest, std::abs(response[0]), 0.005 * largest);
}

/// A sine upwards at the plant's vertical frequency.
GroundMotion resonant_motion(const PlantMatrices& plant, double amplitude) {
  GroundMotion motion;
  motion.time_step = 5e-4;
  for (int i = 0; i < 16'000; ++i)
    motion.vert_acceleration.push_back(
        amplitude * std::sin(2 * std::numbers::pi * plant.vertical_frequency * 5e-4 * i));
  motion.long_acceleration.assign(motion.vert_acceleration.size(), 0);
  motion.lat_acceleration = motion.long_acceleration;
  return motion;
}

TEST(PlantAnalysis, HasTheTransmissibilityOfItsVerticalResonance) {
  const PlantMatrices plant = assemble(example_plant());
  PlantAnalysis analysis{plant, resonant_motion(plant, 0.1), 4e6, 1e-3, 0};

  double largest = 0;
  for (int step = 0; step < 7500; ++step) {
    analysis.predict();
    analysis.correct(Eigen::Vector2d::Zero());
    largest = std::max(largest, analysis.vertical_force());
  }

  // sqrt(1 + 4 zeta^2)/(2 zeta); after 71 periods the transient is exp(-22). Samples of 1 ms miss
  // the peak of a period of 105 ms by 1 - cos(pi/105) at most.
  const double zeta = plant.vertical_damping;
  const double expected =
      plant.mass_per_bearing * 0.1 * std::sqrt(1 + 4 * zeta * zeta) / (2 * zeta);
  EXPECT_NEAR(largest, expected, 1e-3 * expected);
  EXPECT_EQ(analysis.base_displacement().norm(), 0);
}

TEST(PlantAnalysis, LiftsOffWithoutTension) {
  const PlantMatrices plant = assemble(example_plant());
  PlantAnalysis analysis{plant, resonant_motion(plant, 5), 4e6, 1e-3, 0};

  double least = 0;
  for (int step = 0; step < 1000; ++step) {
    analysis.predict();
    least = std::min(least, analysis.vertical_force());
  }

  EXPECT_NEAR(least, -weight_per_bearing(example_plant()), 1);
}

// The measured force of a perfect machine: the target.
TEST(PlantAnalysis, AgreesWithItsModelIfTheMeasuredForceIsTheTarget) {
  const PlantMatrices plant = assemble(example_plant());
  const GroundMotion motion = resonant_motion(plant, 0.1);
  PlantAnalysis model{plant, motion, 4e6, 1e-3, 0};
  PlantAnalysis measured{plant, motion, 4e6, 1e-3, 0, VerticalFeedback::Measured};

  double apart = 0, largest = 0;
  for (int step = 0; step < 1000; ++step) {
    model.predict();
    measured.predict();
    model.correct(Eigen::Vector2d::Zero());
    measured.correct(Eigen::Vector2d::Zero(), measured.vertical_force());
    apart = std::max(apart, std::abs(measured.vertical_force() - model.vertical_force()));
    largest = std::max(largest, std::abs(model.vertical_force()));
  }

  // The target is that of the predicted state, which lacks β dt² of the acceleration: (ωdt)²/4, or
  // 0.09 %. The trapezoidal rule is late by (ωdt)³/12 a step: 60 rad/s for 1 s give 1.8 % of a
  // cycle's radian, less what damping of 5 % forgets within its time constant of 0.33 s: 0.6 %. The
  // dashpot adds γ dt of the velocity's error: 2ζ ωdt/2, or 0.3 %. Together 1 %.
  EXPECT_LT(apart, 0.01 * largest);
}

// A late force acts like negative damping, -ωτ/2: 2.5 ms exceed the 5 % of the plant.
TEST(PlantAnalysis, DivergesWhenTheMeasuredVerticalForceIsLate) {
  const PlantMatrices plant = assemble(example_plant());
  const auto last_force = [&](std::size_t late) {
    GroundMotion motion = resonant_motion(plant, 0.1);
    std::fill(motion.vert_acceleration.begin() + 1000, motion.vert_acceleration.end(), 0);
    PlantAnalysis analysis{plant, motion, 4e6, 1e-3, 0, VerticalFeedback::Measured};
    std::vector<double> line(late + 1, 0.0);
    double largest = 0;
    for (int step = 0; step < 2500; ++step) {
      analysis.predict();
      line.push_back(analysis.vertical_force());
      analysis.correct(Eigen::Vector2d::Zero(), line[line.size() - 1 - late]);
      if (step >= 2300) largest = std::max(largest, std::abs(analysis.vertical_force()));
    }
    return largest;
  };

  // From 0.5 s on the plant is free. Net damping 5 % − 3 % for 1 ms, 5 % − 9 % for 3 ms: exp(∓ζωt).
  EXPECT_LT(last_force(1), last_force(3) / 100);
}

/// A basemat with one mass at 30 m, and the tested bearing off its centre.
IsolatedPlant mass_at_30_m(double bearing_long, double bearing_lat) {
  IsolatedPlant plant;
  plant.basemat_mass = 145e6;
  plant.sticks = {{"building", {335e6}, {30}, 5, 4}};
  plant.spectrum_elevation = 30;
  plant.bearing_long = bearing_long;
  plant.bearing_lat = bearing_lat;
  return plant;
}

/// Largest difference of the compression from that of an inertia force at 30 m, over the largest.
double overturning_error(int substeps, double step, double alpha) {
  const IsolatedPlant plant = mass_at_30_m(40, -30);
  GroundMotion motion = sine_motion();
  for (std::size_t i = 0; i < motion.lat_acceleration.size(); ++i)
    motion.lat_acceleration[i] = 0.5 * motion.long_acceleration[i / 3];
  PlantAnalysis analysis{assemble(plant),         motion,  4e6, step, alpha,
                         VerticalFeedback::Model, substeps};
  double difference = 0, largest = 0;
  for (int i = 0; i < static_cast<int>(std::lround(8 / step)); ++i) {
    const Eigen::Vector2d u = analysis.predict();
    const double compression = analysis.vertical_force();
    analysis.correct(4e6 * u);
    // The mass accelerates to one side and tips the plant to the other.
    const Eigen::Vector2d a = analysis.floor_acceleration(0);
    const double moment_long = -335e6 * 30 * a[0], moment_lat = -335e6 * 30 * a[1];
    const double expected =
        12. / 486 * (moment_long * 40 / (110. * 110) + moment_lat * -30 / (90. * 90));
    difference = std::max(difference, std::abs(compression - expected));
    largest = std::max(largest, std::abs(expected));
  }
  return difference / largest;
}

// The target is that of the predicted state, which lacks Δt²/4 of the acceleration's change and
// Δt/2 of the dashpot's: for the mode of 9 Hz on a free basemat, (ωΔt)²/4 is 0.08 % at 1 ms. The
// extrapolated force of substeps is of the third order.
TEST(PlantAnalysis, CompressesABearingByTheOverturningMoment) {
  EXPECT_LT(overturning_error(1, 1e-3, 0), 0.003);
  EXPECT_LT(overturning_error(10, 1e-2, -0.05), 0.02);
}

TEST(PlantAnalysis, HasNoOverturningAtTheCentre) {
  for (const bool is_at_edge : {false, true}) {
    PlantAnalysis analysis{assemble(mass_at_30_m(0, is_at_edge ? 45 : 0)), sine_motion(), 4e6, 0.01,
                           0};
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d u = analysis.predict();
      EXPECT_EQ(analysis.vertical_force(), 0);  // moves along its other axis
      analysis.correct(4e6 * u);
    }
  }
}

// Overturning acts on one bearing, not on the mean of all: the plant does not move vertically.
TEST(PlantAnalysis, DoesNotRiseByOverturningWhenTheMeasuredForceRestoresIt) {
  const PlantMatrices plant = assemble(mass_at_30_m(40, 0));
  PlantAnalysis model{plant, sine_motion(), 4e6, 0.01, 0};
  PlantAnalysis measured{plant, sine_motion(), 4e6, 0.01, 0, VerticalFeedback::Measured};
  double largest = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector2d u = model.predict();
    measured.predict();
    model.correct(4e6 * u);
    measured.correct(4e6 * u, measured.vertical_force());
    EXPECT_EQ(measured.vertical_force(), model.vertical_force());
    largest = std::max(largest, std::abs(model.vertical_force()));
  }
  EXPECT_GT(largest, 1e5);
}

TEST(PlantAnalysis, MovesOnlyAlongTheExcitedAxis) {
  PlantAnalysis analysis{assemble(example_plant()), sine_motion(), 4e6, 0.01, -0.05};
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d u = analysis.predict();
    EXPECT_EQ(u[1], 0);
    analysis.correct(4e6 * u);
  }
}

TEST(PlantAnalysis, StepsInRealTime) {
  for (const int substeps : {1, 10}) {
    PlantAnalysis analysis{assemble(example_plant()), sine_motion(), 4e6, 0.01, -0.05,
                           VerticalFeedback::Model,   substeps};
    Eigen::Vector2d u = Eigen::Vector2d::Zero();
    for (int i = 0; i < 3; ++i) {
      EXPECT_REALTIME(u = analysis.predict());
      EXPECT_REALTIME(analysis.correct(4e6 * u));
      EXPECT_REALTIME(u = analysis.floor_acceleration(1));
    }
  }
}

// The numerical result at 10 ms, the hybrid test's step, against 1 ms.
TEST(NumericalResponse, HardlyDependsOnTheStep) {
  const PlantMatrices plant = assemble(example_plant());
  const auto coarse = loop::numerical_response(StickModel{plant}, sine_motion(),
                                               test::plain_lead_rubber(), 0.01, 10);
  const auto fine = loop::numerical_response(StickModel{plant}, sine_motion(),
                                             test::plain_lead_rubber(), 0.001, 10);

  const auto peak = [](const std::vector<double>& values) {
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    return largest;
  };
  EXPECT_NEAR(peak(coarse.displacement_long), peak(fine.displacement_long),
              0.03 * peak(fine.displacement_long));
  EXPECT_EQ(coarse.floors.size(), 3U);
  EXPECT_EQ(coarse.floors[0].name, "containment");
}

/// Difference of the bearing's targets from those at 1 ms, of their size: a hybrid test of 10 s
/// with a perfect machine, which moves from target to target on a straight line.
double difference_from_fine(int substeps) {
  const PlantMatrices plant = assemble(example_plant());
  const Bearing bearing = test::plain_lead_rubber();
  const auto fine = loop::numerical_response(StickModel{plant}, sine_motion(), bearing, 1e-3, 10);
  PlantAnalysis analysis{plant,   sine_motion(), initial_stiffness(bearing),
                         0.01,    -0.05,         VerticalFeedback::Model,
                         substeps};
  BearingRun specimen{bearing, 1e-3};
  Eigen::Vector2d at = Eigen::Vector2d::Zero(), force = at;
  double apart = 0, all = 0;
  for (std::size_t step = 0; step < 1000; ++step) {
    const Eigen::Vector2d to = analysis.predict();
    for (int k = 1; k <= 10; ++k) force = test::moved(specimen, at + (to - at) * k / 10);
    at = to;
    analysis.correct(force);
    const double expected = fine.displacement_long[10 * step + 9];
    apart += (to[0] - expected) * (to[0] - expected);
    all += expected * expected;
  }
  return std::sqrt(apart / all);
}

TEST(PlantAnalysis, DiffersLittleFromFineStepsWithSubsteps) {
  EXPECT_GT(difference_from_fine(1), 5e-3);
  EXPECT_LT(difference_from_fine(10), 1e-3);
}

// The largest response to a pulse in the last third of 30 s, as a part of that in the first one.
double growth(double stiffness, double softening, int substeps) {
  GroundMotion pulse;
  pulse.time_step = 0.01;
  pulse.long_acceleration = {1, -0.7, 1, -0.7, 1, 0};
  pulse.lat_acceleration.assign(6, 0.0);
  PlantAnalysis analysis{assemble(example_plant()), pulse,   stiffness, 0.01, 0,
                         VerticalFeedback::Model,   substeps};
  double first = 0, last = 0;
  for (int step = 0; step < 3000; ++step) {
    const Eigen::Vector2d u = analysis.predict();
    analysis.correct(softening * stiffness * u);
    const double a = analysis.floor_acceleration(0).norm();
    if (step < 1000) first = std::max(first, a);
    if (step >= 2000) last = std::max(last, a);
  }
  return last / first;
}

TEST(PlantAnalysis, IsStableWithSubstepsUpToTheLargestStiffness) {
  const PlantMatrices plant = assemble(example_plant());
  for (const double phase : {0.2, 0.5, 0.8}) {  // of the basemat on its bearings, in a step
    const double stiffness = 0.999 * phase * phase / 1e-4 * plant.M(0, 0) / plant.bearings;
    for (const int substeps : {2, 10})
      for (const double softening : {0.02, 0.1, 0.3, 0.6, 1.0})
        EXPECT_LT(growth(stiffness, softening, substeps), 1)
            << phase << ", " << substeps << " substeps, softening " << softening;
  }
}

TEST(PlantAnalysis, RefusesSubstepsThatItCannotUse) {
  const auto analyse = [](double stiffness, int substeps) {
    PlantAnalysis{assemble(example_plant()), sine_motion(), stiffness, 0.01, 0,
                  VerticalFeedback::Model,   substeps};
  };

  EXPECT_EQ(test::error_of([&] { analyse(4e6, 0); }),
            "integrator: 0 substeps, expected at least 1");
  EXPECT_EQ(test::error_of([&] { analyse(4e9, 2); }),
            "integrator: substeps need a step of at most 0.00691 s with a bearing of 4e+09 N/m, "
            "not 0.01 s; shorten the step or set substeps to 1");
}

}  // namespace
}  // namespace rths::sim

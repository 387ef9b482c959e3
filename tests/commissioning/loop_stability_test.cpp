// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/commissioning/loop_stability.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::commissioning {
namespace {

using Complex = std::complex<double>;

std::vector<double> frequencies_up_to(double highest_hz) {
  std::vector<double> omega;
  for (int i = 0; i < 6000; ++i)
    omega.push_back(2 * std::numbers::pi * 0.02 * std::pow(highest_hz / 0.02, i / 5999.0));
  return omega;
}

/// The structure of a public benchmark and the delay at which its loop becomes unstable.
/// Source: Silva, Gomez, Maghareh, Dyke & Spencer (2020), MSSP 135:106381; the delays are the
/// roots of its equations, computed independently.
struct Benchmark {
  double floor_mass, damping_ratio, critical_delay;
  friend std::ostream& operator<<(std::ostream& out, const Benchmark& b) {
    return out << b.floor_mass << " kg, " << b.damping_ratio;
  }
};
class BenchmarkLoop : public ::testing::TestWithParam<Benchmark> {};

constexpr double kSpecimenMass = 29.13, kSpecimenStiffness = 1.19e6, kSpecimenDamping = 114.2;

HybridLoop loop_of(const Benchmark& benchmark) {
  Eigen::Matrix3d K;
  K << 26054883.879603837, -23133938.877108198, 5937035.463339146, -23133938.877108198,
      32560774.186380334, -14419970.777236981, 5937035.463339146, -14419970.777236985,
      9267275.506224312;
  K = (0.5 * (K + K.transpose())).eval();
  const double m = benchmark.floor_mass;
  const auto modes = maths::symmetric_modes(K / m);
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero(), M = m * Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i)
    C += 2 * benchmark.damping_ratio * std::sqrt(modes.values[i]) * m * modes.vectors.col(i) *
         modes.vectors.col(i).transpose();
  // The numerical part is the reference structure without the specimen.
  M(0, 0) -= kSpecimenMass;
  K(0, 0) -= kSpecimenStiffness;
  C(0, 0) -= kSpecimenDamping;
  const auto omega = frequencies_up_to(100);
  std::vector<Complex> flexibility, transfer;
  for (const double w : omega) {
    Eigen::MatrixXd matrix(6, 6);
    matrix << K - w * w * M, -w * C, w * C, K - w * w * M;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(6);
    load[0] = 1;
    const Eigen::VectorXd x = maths::solve_least_squares(matrix, load);
    flexibility.emplace_back(x[0], x[3]);
    // The inertia and damping of the specimen are measured with its force.
    transfer.push_back(Complex{kSpecimenStiffness - w * w * kSpecimenMass, w * kSpecimenDamping} /
                       kSpecimenStiffness);
  }
  return {omega, flexibility, transfer};
}

TEST_P(BenchmarkLoop, HasThePublishedCriticalDelay) {
  const auto loop = loop_of(GetParam());

  EXPECT_EQ(loop.unstable_poles(kSpecimenStiffness), 0);
  // The published numbers have two decimals; the frequencies are 0.14 % apart.
  EXPECT_NEAR(loop.delay_margin(kSpecimenStiffness), GetParam().critical_delay, 3e-5);
  // A pair of poles crosses.
  EXPECT_EQ(loop.unstable_poles(kSpecimenStiffness, GetParam().critical_delay + 2e-4), 2);
}

INSTANTIATE_TEST_SUITE_P(Silva2020, BenchmarkLoop,
                         ::testing::Values(Benchmark{1000, 0.05, 14.64e-3},
                                           Benchmark{1100, 0.04, 12.23e-3},
                                           Benchmark{1300, 0.03, 9.92e-3},
                                           Benchmark{1000, 0.03, 8.73e-3}));

// One mass on a spring k with the damping c, and a spring N = k/2 in the machine with T = 1/(1+sT):
// m s² + c s + k + N/(1 + sT) has the limit of Routh's criterion below.
TEST(Loop, HasTheGainMarginOfRouth) {
  constexpr double m = 1, c = 0.8, k = 100, N = 50, T = 0.01;
  const auto omega = frequencies_up_to(200);
  std::vector<Complex> flexibility, transfer;
  for (const double w : omega) {
    flexibility.push_back(1.0 / Complex{k - m * w * w, c * w});
    transfer.push_back(1.0 / Complex{1, w * T});
  }
  const HybridLoop loop{omega, flexibility, transfer};

  // mT s³ + (m + cT) s² + (c + kT) s + k + gN: stable if (m + cT)(c + kT) > mT (k + gN).
  const double limit = ((m + c * T) * (c + k * T) / (m * T) - k) / N;
  EXPECT_EQ(loop.unstable_poles(N), 0);
  EXPECT_NEAR(loop.gain_margin(N), limit, 1e-2 * limit);
  EXPECT_EQ(loop.unstable_poles(N, 0, 1.1 * limit), 2);
  EXPECT_EQ(loop.gain_margin(2 * limit * N), 1);
  EXPECT_EQ(loop.delay_margin(2 * limit * N), 0);
}

TEST(Loop, RefusesSignalsOfUnequalLength) {
  EXPECT_THROW((HybridLoop{{1, 2}, {Complex{1}}, {Complex{1}}}), Error);
}

sim::Bearing bearing_of(const char* terms) {
  return sim::read_bearing(Config::parse(terms, "bearing"), 1e6);
}

TEST(DescribingFunction, OfASpringIsItsStiffness) {
  const auto bearing = bearing_of(R"(
bearing = 1
title = "spring"
[polynomial_stiffness]
linear_N_per_m = 3e6
)");
  const auto found = describing_function(bearing, 0.1, 1);
  EXPECT_NEAR(found.real(), 3e6, 1e3);
  EXPECT_NEAR(found.imag(), 0, 1e3);
}

// A textbook result: 4 F/(π A), in phase with the velocity.
TEST(DescribingFunction, OfFrictionIsADamper) {
  const auto bearing = bearing_of(R"(
bearing = 1
title = "friction"
[coulomb_friction]
friction_force_N = 1e4
presliding_m = 1e-6
)");
  const auto found = describing_function(bearing, 0.1, 1);
  EXPECT_NEAR(found.imag(), 4e4 / (std::numbers::pi * 0.1), 1e3);
  EXPECT_NEAR(found.real(), 0, 2e3);
}

TEST(MachineTransfer, HasTheLagOfThePositionLoopAndYieldsToItsSpecimen) {
  sim::AxisTransfer machine;
  machine.transport_delay = 0.004;
  const double w = 0.1;
  const auto bare = transfer_at(machine, 0, 0, w);
  // The valve is inside the position loop: its lag is of second order for slow motion.
  EXPECT_NEAR(-std::arg(bare) / w, 1 / machine.gain + machine.transport_delay, 1e-5);
  EXPECT_NEAR(std::abs(bare), 1, 1e-4);

  // Without rates: K (r − x) = (κ + l) N x.
  machine.pressure_feedback = 2e-9;
  machine.leakage = 1e-9;
  const double stiffness = 1e9;
  EXPECT_NEAR(std::abs(transfer_at(machine, stiffness, 0, 1e-6)),
              machine.gain / (machine.gain + 3e-9 * stiffness), 1e-6);

  // Slow pressure is not fed back: K (r − x) = l N x.
  machine.pressure_washout = 1;
  EXPECT_NEAR(std::abs(transfer_at(machine, stiffness, 0, 1e-6)),
              machine.gain / (machine.gain + 1e-9 * stiffness), 1e-6);
}

}  // namespace
}  // namespace rths::commissioning

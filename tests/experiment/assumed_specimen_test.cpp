// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/block_settings.hpp>

#include <limits>

#include <gtest/gtest.h>

namespace rths::experiment {
namespace {

constexpr double kAxialLoad = 9.7e6, kPeriod = 1e-3;  // [N], [s]
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

sim::Bearing slider() {
  return sim::read_bearing(Config::parse("bearing = 1\ntitle = \"t\"\n[flat_slider]\n"
                                         "friction_coefficient = 0.1\n"
                                         "initial_stiffness_N_per_m = 1e9\n",
                                         "b.toml"),
                           kAxialLoad);
}

TEST(AssumedSpecimen, IsTheBearingAlongItsAxes) {
  const Eigen::Vector2d move{0.03, 0.04}, still = Eigen::Vector2d::Zero();
  const auto both = assumed_specimen(slider(), {"long", "lat"}, kPeriod)();
  const auto lat = assumed_specimen(slider(), {"lat"}, kPeriod)();

  const Eigen::Vector2d pull = both->move(move, still, kNotANumber);
  const Eigen::VectorXd along_lat =
      lat->move(Eigen::VectorXd::Constant(1, -0.05), Eigen::VectorXd::Zero(1), kNotANumber);

  EXPECT_NEAR(pull[0], 0.6 * 0.1 * kAxialLoad, 1);
  EXPECT_NEAR(pull[1], 0.8 * 0.1 * kAxialLoad, 1);
  ASSERT_EQ(along_lat.size(), 1);
  EXPECT_NEAR(along_lat[0], -0.1 * kAxialLoad, 1);
}

TEST(AssumedSpecimen, BearsTheGivenLoad) {
  const auto specimen = assumed_specimen(slider(), {"long"}, kPeriod)();

  const Eigen::VectorXd force =
      specimen->move(Eigen::VectorXd::Constant(1, 0.05), Eigen::VectorXd::Zero(1), 2e6);

  EXPECT_NEAR(force[0], 0.1 * 2e6, 1);
}

}  // namespace
}  // namespace rths::experiment

// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/specimen_sliders.hpp>

#include <numeric>

#include <gtest/gtest.h>

namespace rths::adapters {
namespace {

constexpr double kAxialLoad = 9.7e6;  // [N]

sim::Bearing bearing(const std::string& terms) {
  return sim::read_bearing(Config::parse("bearing = 1\ntitle = \"t\"\n" + terms, "b.toml"),
                           kAxialLoad);
}

double total(const std::vector<double>& strengths) {
  return std::accumulate(strengths.begin(), strengths.end(), 0.0);
}

// Reaches of the search are 9 % apart, so each is within 4.5 %.
TEST(SpecimenSliders, HaveTheReachOfASharpSlider) {
  const auto found = sliders_of(
      bearing("[bilinear]\ncharacteristic_strength_N = 1e6\npost_yield_stiffness_N_per_m = 4e6\n"
              "yield_displacement_m = 3e-3\n"));

  ASSERT_FALSE(found.sharp.empty());
  EXPECT_EQ(found.sharp.back(), 1);  // the spring
  ASSERT_EQ(found.strengths.size(), found.sharp.size() + found.smooth.size());
  // The stiffness before yield: of all sliders together.
  double stiffness = 0;
  for (std::size_t j = 0; j < found.strengths.size(); ++j)
    stiffness += found.strengths[j] /
                 (j < found.sharp.size() ? found.sharp[j] : found.smooth[j - found.sharp.size()]);
  EXPECT_NEAR(stiffness, 4e6 + 1e6 / 3e-3, 0.05 * 1e6 / 3e-3);
  EXPECT_NEAR(found.strengths[found.sharp.size() - 1], 4e6, 0.02 * 4e6);
  EXPECT_NEAR(total(found.strengths) - found.strengths[found.sharp.size() - 1], 1e6, 0.02 * 1e6);
}

TEST(SpecimenSliders, AreSmoothForALawOfBoucAndWen) {
  const auto found = sliders_of(
      bearing("[bouc_wen]\ncharacteristic_strength_N = 1e6\npost_yield_stiffness_N_per_m = 4e6\n"
              "yield_displacement_m = 3e-3\n"));

  ASSERT_GE(found.smooth.size(), 1U);
  const std::size_t spring = found.sharp.size() - 1;  // of the longest reach
  double most = 0, reach = 0;
  for (std::size_t j = 0; j < found.smooth.size(); ++j)
    if (found.strengths[spring + 1 + j] > most) {
      most = found.strengths[spring + 1 + j];
      reach = found.smooth[j];
    }
  EXPECT_NEAR(reach, 3e-3, 0.15 * 3e-3);
  EXPECT_GT(most, 0.8e6);
  EXPECT_NEAR(total(found.strengths) - found.strengths[spring], 1e6, 0.02 * 1e6);
}

TEST(SpecimenSliders, OfASpringIsOneOfLongReach) {
  const auto found = sliders_of(bearing("[mer_spring]\nstiffness_N_per_m = 5e6\ngap_m = 0\n"));

  EXPECT_EQ(found.sharp, std::vector<double>{1});
  EXPECT_TRUE(found.smooth.empty());
  EXPECT_NEAR(found.strengths[0], 5e6, 1);
}

}  // namespace
}  // namespace rths::adapters

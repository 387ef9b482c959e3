// SPDX-License-Identifier: Apache-2.0
#include <rths/session/plant.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

experiment::Experiment example(const char* name, const experiment::Overrides& changes = {}) {
  return app::load_experiment(test::source_tree() / "examples" / name, changes);
}

// The number after a text.
double number_after(const std::string& text, const std::string& before) {
  const auto at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before << " in " << text;
  return at == std::string::npos ? NAN : std::stod(text.substr(at + before.size()));
}

TEST(LargePlantOfATest, IsDescribed) {
  const std::string text = describe_plant(example("ant_486.toml"), 3);

  EXPECT_EQ(text.rfind("plant: 5676 degrees of freedom", 0), 0U) << text;
  // The mean load is the weight of the plant's mass over its bearings.
  EXPECT_NEAR(number_after(text, "mean "), 480e6 * 9.80665 / 486 / 1e6, 0.001);
  EXPECT_NEAR(number_after(text, "modes on yielded bearings: "), 0.329, 0.001);
}

TEST(LargePlantOfATest, IsCheckedAgainstAllDegreesOfFreedom) {
  const std::string text = check_plant(example("ant_486.toml"), 2),
                    coarse = check_plant(
                        example("ant_486.toml", {{"plant.frequency_limit_Hz", "10"}}), 2);

  const char* const tested = "displacement of the tested bearing ";
  EXPECT_LT(number_after(text, tested), 0.05);
  EXPECT_EQ(text.find("warning"), std::string::npos) << text;
  EXPECT_GT(number_after(coarse, tested), number_after(text, tested));
  EXPECT_NE(coarse.find("expected 46.2 Hz, 1.4 times"), std::string::npos) << coarse;
}

TEST(LargePlantOfATest, IsNoPlantOfSticks) {
  const auto error =
      test::error_of([] { static_cast<void>(describe_plant(example("srmd_lprb_2d.toml"), 3)); });

  EXPECT_NE(
      error.find("srmd_lprb_2d.toml: the plant is one of sticks, expected [plant] with model"),
      std::string::npos)
      << error;
}

}  // namespace
}  // namespace rths::session

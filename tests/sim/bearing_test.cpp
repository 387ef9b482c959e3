// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/bearing.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include <rths/sim/loop_test.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::sim {
namespace {

using test::error_of;
using test::kAxialLoad;

Bearing parsed_bearing(const std::string& text) {
  return read_bearing(Config::parse(text, "b.toml"), kAxialLoad);
}

constexpr const char* kPlain =
    "[bouc_wen]\ncharacteristic_strength_N = 1e6\nyield_displacement_m = 1e-3\n"
    "post_yield_stiffness_N_per_m = 4e6\n";

TEST(Bearing, RejectsUnknownKeysAndEmptyFiles) {
  EXPECT_EQ(error_of([] { parsed_bearing(std::string{"titel = \"a\"\n"} + kPlain); }),
            "b.toml:1:9: unknown key 'titel' (did you mean 'title'?)");
  EXPECT_EQ(error_of([] { parsed_bearing("title = \"a\"\n"); }),
            "b.toml:1:1: the bearing has no terms, expected at least one");
}

TEST(Bearing, RefusesTermsWhoseInputsItDoesNotHave) {
  for (const char* kind : {"elastomeric_axial", "multilinear_axial", "pendulum_lift"}) {
    Bearing bearing = test::plain_lead_rubber();
    bearing.terms.push_back({kind, "", {}});
    EXPECT_EQ(error_of([&] { BearingRun(bearing, 1e-3); }),
              "term '" + std::string{kind} +
                  "' needs a vertical displacement, but the axial load is prescribed here: leave "
                  "the term out (enabled = false)");
    EXPECT_NE(error_of([&] { static_cast<void>(run_loop_test(bearing, {})); }), "") << kind;
  }
  EXPECT_EQ(error_of([] { parsed_bearing("[platen_inertia]\nmass_kg = 1e4\n"); }),
            "b.toml:1:1: term 'platen_inertia' needs the acceleration, an input that a specimen "
            "does not have; it belongs to the machine");
}

TEST(Bearing, HasTheAmbientTemperature) {
  constexpr double kFall = 0.007, kColder = -30;  // [1/K], [K]
  const std::string ageing =
      "[ageing_temperature]\nstrength_temperature_1_per_K = 0.007\n"
      "stiffness_temperature_1_per_K = 0.007\n";
  BearingRun cold{parsed_bearing("temperature_above_reference_K = -30\n" + (kPlain + ageing)),
                  1e-3};
  BearingRun usual{parsed_bearing(kPlain + ageing), 1e-3};

  // At 50 yield displacements the force is Q_d + K_d u, and both scale with temperature alike.
  EXPECT_NEAR(test::moved(cold, {0.05, 0})[0] / test::moved(usual, {0.05, 0})[0],
              std::exp(-kFall * kColder), 1e-9);
}

TEST(Bearing, HasTheLargestStiffnessOfACycle) {
  const double plain = initial_stiffness(parsed_bearing(kPlain));
  EXPECT_NEAR(plain, 1e6 / 1e-3 + 4e6, 1e-4 * plain);
  // Play in front of the bearing is left out and does not hide its stiffness.
  EXPECT_EQ(initial_stiffness(
                parsed_bearing(kPlain + std::string{"[transducer_backlash]\ngap_m = 2e-3\n"})),
            plain);
  // A wall at a distance of 0.2 m.
  EXPECT_NEAR(
      initial_stiffness(parsed_bearing("[mer_spring]\nstiffness_N_per_m = 5e8\ngap_m = 0.2\n")),
      5e8, 5e2);
}

TEST(Bearing, HasNoStiffnessIfNoTermHas) {
  EXPECT_EQ(error_of([] {
              static_cast<void>(initial_stiffness(parsed_bearing(
                  "title = \"d\"\n[viscous_friction]\ncoefficient_N_s_per_m = 1\n")));
            }),
            "bearing 'd': its stiffness is 0 N/m, expected a positive number");
}

// Readers copy the page's example first.
TEST(Bearing, OfThePageLoads) {
  const std::string page = test::content_of(test::source_tree() / "docs/bearings.md");
  const auto begin = page.find("title = ");
  ASSERT_NE(begin, std::string::npos);
  const std::string code = page.substr(begin, page.find("```", begin) - begin);

  const Bearing bearing = parsed_bearing(code);

  EXPECT_EQ(bearing.terms.size(), 2U);
  EXPECT_EQ(error_of([&] { BearingRun(bearing, 1e-3); }), "");
}

}  // namespace
}  // namespace rths::sim

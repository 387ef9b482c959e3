// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/composition.hpp>

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::sim {
namespace {

using test::error_of;

std::vector<TermSettings> parsed_terms(const std::string& text) {
  return read_terms(Config::parse(text, "b.toml"));
}

TEST(Composition, SortsTermsIntoTheCataloguesOrder) {
  const Composition composition{{{"coulomb_friction", "", {}}, {"bouc_wen", "", {}}}, 1e-3};

  EXPECT_EQ(composition.terms()[0].name, "bouc_wen");
  EXPECT_EQ(composition.terms()[1].name, "coulomb_friction");
}

TEST(Composition, RepeatsItsForcesFromACopiedState) {
  const Composition bearing{{{"bouc_wen", "", {{"characteristic_strength", 1e6}}}}, 1e-3};
  std::vector<double> state(bearing.states());
  Quantities<double> q;
  q.displacement = {0.01, 0.002};
  bearing.advance(state, q);
  const auto saved = state;

  Quantities<double> first, again;
  first.displacement = again.displacement = {0.02, -0.01};
  bearing.advance(state, first);
  state = saved;
  bearing.advance(state, again);

  EXPECT_EQ(first.force, again.force);
}

TEST(Composition, LimitsALawOfBothAxesToOneOfThem) {
  const std::vector<std::pair<std::string, double>> values{{"characteristic_strength", 1e6},
                                                           {"post_yield_stiffness", 1e6}};
  const Composition plane{{{"bouc_wen", "", values}}, 1e-3};
  const Composition along{{{"bouc_wen", "", values, 1}}, 1e-3};
  std::vector<double> whole(plane.states()), half(along.states());
  Quantities<double> alone, both;
  alone.displacement = {0.002, 0};
  both.displacement = {0.002, -0.003};

  plane.advance(whole, alone);
  along.advance(half, both);

  EXPECT_EQ(both.force[0], alone.force[0]);
  EXPECT_EQ(both.force[1], 0);
  EXPECT_EQ(both.displacement[1], -0.003);
}

TEST(Composition, RefusesUnknownNamesAndValuesOutOfBounds) {
  const auto build = [](const TermSettings& term) {
    return error_of([&] { Composition({term}, 1e-3); });
  };
  EXPECT_EQ(build({"bouc_wenn", "", {}}),
            "there is no term 'bouc_wenn' (did you mean 'bouc_wen'?)");
  EXPECT_EQ(build({"bouc_wen", "", {{"strength", 1}}}),
            "term 'bouc_wen' has no parameter 'strength'");
  EXPECT_EQ(build({"bouc_wen", "", {{"beta", 2}}}), "term 'bouc_wen': beta is 2, expected 0 to 1");
  EXPECT_EQ(build({"planar_friction", "", {}, 1}),
            "term 'planar_friction' couples both axes; it cannot be limited to one");
  EXPECT_EQ(error_of([] {
              Composition({{"bouc_wen", "", {}}, {"bouc_wen", "", {}}}, 1e-3);
            }),
            "two terms have the name 'bouc_wen'");
  EXPECT_EQ(error_of([] { Composition({}, 0); }),
            "time step of a composition is 0, expected a positive number");
}

TEST(TermReader, ReadsTermsWithUnitsInTheirKeys) {
  const auto terms = parsed_terms("[bouc_wen]\ncharacteristic_strength_N = 1e6\nbeta = 0.9\n");

  ASSERT_EQ(terms.size(), 1U);
  EXPECT_EQ(terms[0].kind, "bouc_wen");
  ASSERT_EQ(terms[0].parameters.size(), 2U);
  EXPECT_EQ(terms[0].parameters[0].first, "characteristic_strength");
  EXPECT_EQ(terms[0].parameters[0].second, 1e6);
}

TEST(TermReader, MakesATermOfEachAxisFromAnArray) {
  const auto terms = parsed_terms("[coulomb_friction]\nfriction_force_N = [5100, 8600]\n");

  ASSERT_EQ(terms.size(), 2U);
  EXPECT_EQ(terms[0].name, "coulomb_friction.long");
  EXPECT_EQ(terms[0].axes, 0b01U);
  EXPECT_EQ(terms[1].axes, 0b10U);
  EXPECT_EQ(terms[1].parameters[0].second, 8600);
}

TEST(TermReader, LeavesOutDisabledTerms) {
  EXPECT_TRUE(parsed_terms("[bouc_wen]\nenabled = false\n").empty());
}

TEST(TermReader, TakesALoopOnOneAxis) {
  const auto terms = parsed_terms("[bouc_wen]\naxes = [\"long\"]\n");

  ASSERT_EQ(terms.size(), 1U);
  EXPECT_EQ(terms[0].axes, 0b01U);
}

TEST(TermReader, ReportsTheLineOfAWrongKeyOrValue) {
  EXPECT_EQ(error_of([] { parsed_terms("[bouc_wen]\nbeta = 1.5\n"); }),
            "b.toml:2:8: beta is 1.5, expected 0 to 1");
  EXPECT_EQ(error_of([] { parsed_terms("[bouc_wen]\nbetta = 0.5\n"); }),
            "b.toml:2:9: unknown key 'betta' (did you mean 'beta'?)");
  EXPECT_EQ(error_of([] { parsed_terms("[x]\nkind = \"bouc_wem\"\n"); }),
            "b.toml:2:8: there is no term 'bouc_wem' (did you mean 'bouc_wen'?)");
  EXPECT_EQ(error_of([] { parsed_terms("[bouc_wen]\nbeta = [0.5, 0.5]\n"); }),
            "b.toml:2:8: beta is an array, but 'bouc_wen' couples both axes");
}

TEST(TermReader, ReportsTheLineOfWrongAxesAndChannels) {
  const auto error = [](const std::string& text) { return error_of([&] { parsed_terms(text); }); };
  EXPECT_EQ(error("[coulomb_friction]\naxes = []\n"),
            "b.toml:2:8: axes is empty, expected long, lat or both");
  EXPECT_EQ(error("[planar_friction]\naxes = [\"long\"]\n"),
            "b.toml:2:8: 'planar_friction' couples both axes; it cannot be limited to one");
  EXPECT_EQ(error("[bouc_wen]\nchannel = \"force\"\n"),
            "b.toml:2:11: 'bouc_wen' has no selectable channel");
  EXPECT_EQ(error("[coulomb_friction]\naxes = [\"long\"]\nfriction_force_N = [1, 2]\n"),
            "b.toml:3:20: friction_force_N is an array [long, lat] and axes is set: expected only "
            "one of the two");
  EXPECT_EQ(error("[gain]\nchannel = \"axial_load\"\nfactor = [2, 3]\n"),
            "b.toml:3:10: factor is an array, but the axial load has no axes");
  EXPECT_EQ(error("[gain]\nchannel = \"axial_load\"\naxes = [\"lat\"]\n"),
            "b.toml:3:8: axes is set, but the axial load has no axes");
  EXPECT_EQ(
      error("[crosstalk_horizontal]\nchannel = \"axial_load\"\n"),
      "b.toml:2:11: 'crosstalk_horizontal' acts between the horizontal axes; the axial load has no "
      "axes");
}

TEST(TermReader, RefusesTermsThatTheirOwnerCannotHave) {
  const auto error = [](const std::string& text, TermOwner owner) {
    return error_of([&] { static_cast<void>(read_terms(Config::parse(text, "b.toml"), owner)); });
  };
  EXPECT_EQ(error("[x]\nkind = \"bouc_wen\"\n", TermOwner::Machine),
            "b.toml:1:1: term 'x' belongs to the specimen (stage restoring), expected one of the "
            "stages actuator, motion, machine or sensor");
  EXPECT_EQ(error("[gain]\n", TermOwner::Specimen),
            "b.toml:1:1: term 'gain' belongs to the machine (stage sensor), not to a specimen");
  EXPECT_EQ(error("[coulomb_friction]\n", TermOwner::Specimen), "");
  for (const TermOwner owner : {TermOwner::Specimen, TermOwner::Machine})
    EXPECT_EQ(error("[current_dependent_damping]\n", owner),
              "b.toml:1:1: term 'current_dependent_damping' needs a control current, an input that "
              "neither specimens nor machines have");
}

}  // namespace
}  // namespace rths::sim

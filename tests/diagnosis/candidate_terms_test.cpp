// SPDX-License-Identifier: Apache-2.0
// The table of terms that may be missing, against the catalogue.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/sim/term.hpp>

#include "diagnosis/models/src/composition_simulator.hpp"
#include "diagnosis/models/src/library.hpp"
#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

// All sizes differ, none is zero.
NaturalScale some_scale() {
  NaturalScale scale;
  scale.displacement = 0.1;
  scale.velocity = 0.4;
  scale.acceleration = 3;
  scale.force = 2e5;
  scale.axial_load = 1e6;
  scale.duration = 40;
  scale.output = 1.5e5;
  scale.auxiliary = 2;
  scale.time = 0.7;
  return scale;
}

bool is_candidate(std::string_view kind) {
  const auto terms = candidate_terms();
  return std::any_of(terms.begin(), terms.end(), [&](const auto& one) { return one.kind == kind; });
}

TEST(CandidateTerms, CoverTheCatalogueOrSayWhyNot) {
  for (const auto& kind : sim::catalogue()) {
    const auto others = terms_not_searched();
    const auto is_named = std::any_of(others.begin(), others.end(),
                                      [&](const auto& one) { return one.first == kind.name; });
    EXPECT_NE(is_candidate(kind.name), is_named) << kind.name;
  }
}

TEST(CandidateTerms, CoverFreeModelsOrSayWhyNot) {
  constexpr unsigned kFree = kOnConnection | kOnInput | kOnOutput;
  const auto others = terms_not_searched_freely();
  for (const auto& term : candidate_terms()) {
    const auto entries = candidate_terms();
    const bool is_searched = std::any_of(entries.begin(), entries.end(), [&](const auto& one) {
      return one.kind == term.kind && (one.places & kFree) != 0;
    });
    const bool is_named = std::any_of(others.begin(), others.end(),
                                      [&](const auto& one) { return one.first == term.kind; });
    EXPECT_NE(is_searched, is_named) << term.kind;
  }
}

TEST(CandidateTerms, AreExplainedWhereTheyAreNotSearchedFor) {
  std::stringstream page;
  page << std::ifstream{test::source_tree() / "docs/diagnosis_models.md"}.rdbuf();
  const std::string text = page.str().substr(page.str().find("## Terms that are not searched for"));
  for (const auto& terms : {terms_not_searched(), terms_not_searched_freely()})
    for (const auto& [kind, reason] : terms) {
      EXPECT_NO_THROW(static_cast<void>(sim::term_kind(kind)));
      EXPECT_FALSE(reason.empty()) << kind;
      EXPECT_NE(text.find("`" + std::string{kind} + "`"), std::string::npos) << kind;
    }
}

TEST(CandidateTerms, HaveParametersOfTheirKindThatCanBeFitted) {
  for (const auto& term : candidate_terms()) {
    const sim::TermKind& kind = sim::term_kind(term.kind);
    bool is_fitted = false;
    for (const auto& parameter : term.parameters) {
      const sim::Parameter& known = sim::parameter_of(kind, parameter.name);
      using Role = CandidateParameter::Role;
      is_fitted = is_fitted || parameter.role == Role::Size || parameter.role == Role::Shape;
      EXPECT_EQ(parameter.starts.empty(), parameter.role == Role::Typical) << known.name;
      const double unit = natural_unit(known.unit, some_scale());
      EXPECT_TRUE(std::isfinite(unit) && unit > 0) << kind.name << " " << known.name;
      if (parameter.low < parameter.high)
        for (const double start : parameter.starts) {
          EXPECT_GE(start, parameter.low) << kind.name << " " << known.name;
          EXPECT_LE(start, parameter.high) << kind.name << " " << known.name;
        }
    }
    EXPECT_TRUE(is_fitted) << kind.name;
    for (const auto& simpler : term.contains) EXPECT_TRUE(is_candidate(simpler)) << simpler;
    EXPECT_FALSE(term.waits && term.contains.empty()) << kind.name;
  }
}

// A specimen that moves at 1 Hz.
NaturalScale at_one_hertz(double force, double displacement) {
  constexpr double kCircle = 2 * std::numbers::pi;
  NaturalScale scale;
  scale.displacement = displacement;
  scale.velocity = displacement * kCircle;
  scale.acceleration = scale.velocity * kCircle;
  scale.force = force;
  scale.axial_load = force;
  scale.duration = 10;
  scale.output = force;
  scale.auxiliary = 1;
  return scale;
}

// Bounds that do not grow with the specimen.
bool is_without_size(const sim::Parameter& parameter) {
  const bool is_ratio = parameter.unit == "-" || parameter.unit == "1/K";
  const bool is_time = parameter.unit == "s";  // of a controller, a filter or a material
  // Of the vertical force alone.
  const bool is_of_load = parameter.name == "contact_area" || parameter.name == "pressure_scale" ||
                          parameter.name == "reference_pressure";
  return is_ratio || is_time || is_of_load;
}

void expect_room(const CandidateTerm& term, double force, double displacement) {
  const NaturalScale scale = at_one_hertz(force, displacement);
  using Role = CandidateParameter::Role;
  for (const auto& parameter : term.parameters) {
    const sim::Parameter& known = sim::parameter_of(sim::term_kind(term.kind), parameter.name);
    if (parameter.role == Role::Typical || is_without_size(known)) continue;
    const double unit = natural_unit(known.unit, scale);
    // A size that is fitted without bounds of its own may grow tenfold.
    const double most = *std::max_element(parameter.starts.begin(), parameter.starts.end());
    const bool is_bounded = parameter.low < parameter.high;
    const double growth = parameter.role == Role::Size ? 10 : 1;
    EXPECT_LE((is_bounded ? parameter.high : growth * most) * unit, known.high * (1 + 1e-9))
        << term.kind << " " << known.name << " of " << force << " N and " << displacement << " m";
    const double least = *std::min_element(parameter.starts.begin(), parameter.starts.end());
    EXPECT_GE((is_bounded ? parameter.low : least) * unit, known.low * (1 - 1e-9))
        << term.kind << " " << known.name << " of " << force << " N and " << displacement << " m";
  }
}

TEST(CandidateTerms, HaveRoomInTheCatalogueForSmallAndLargeSpecimens) {
  for (const auto& term : candidate_terms()) {
    const bool is_scaled = (term.places & (kOnConnection | kOnInput | kOnOutput)) != 0;
    // Other sizes of a free model are scaled into this range.
    if (is_scaled)
      for (const double force : {1e-2, 1e6})
        for (const double displacement : {1e-3, 0.3}) expect_room(term, force, displacement);
    if ((term.places & (kOnForce | kOnActuator | kOnAccelerometer)) != 0)
      for (const double force : {1.0, 1e8})
        for (const double displacement : {1e-4, 1.0}) expect_room(term, force, displacement);
  }
}

TEST(NaturalUnits, AreProductsOfSizes) {
  const NaturalScale scale = some_scale();

  EXPECT_NEAR(natural_unit("N*s/m", scale), scale.force / scale.velocity, 1e-9);
  EXPECT_NEAR(natural_unit("N/m3", scale), scale.force / std::pow(scale.displacement, 3), 1e-3);
  EXPECT_NEAR(natural_unit("1/J", scale), 1 / (scale.force * scale.displacement), 1e-15);
  EXPECT_NEAR(natural_unit("N/A2", scale), scale.force / 4, 1e-9);
  EXPECT_NEAR(natural_unit("channel", scale), scale.output, 1e-9);
  EXPECT_NEAR(natural_unit("channel/s", scale), scale.output / scale.duration, 1e-9);
  EXPECT_NEAR(natural_unit("kg", scale), scale.force / scale.acceleration, 1e-9);
  EXPECT_EQ(natural_unit("s", scale), scale.time);
  EXPECT_EQ(natural_unit("-", scale), 1);
}

TEST(NaturalUnits, RefuseAnUnknownUnit) {
  EXPECT_THROW(static_cast<void>(natural_unit("N/furlong", some_scale())), Error);
}

// Every candidate at every place can be made: with all needs met, each kind gives one.
TEST(CandidateTerms, AreOfferedToACompleteRecordingOfASlider) {
  Hypothesis base;
  base.terms.push_back({{"single_pendulum", "single_pendulum", {}}, ""});
  const NaturalScale scale = some_scale();

  const auto candidates = candidates_of(kOnForce, base, scale, {0, 1}, {scale, scale}, {});

  for (const char* name :
       {"velocity_dep_sliding", "friction_heating", "pressure_dep_sliding", "pressure_tanh_sliding",
        "rim_stop", "mer_spring", "degradation", "planar_friction", "flat_slider", "power_damping"})
    EXPECT_TRUE(std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& one) {
      return one.name == name;
    })) << name;
  // On one axis, one common parameter for both is simpler.
  const auto drag = [&](const std::string& axis) {
    return std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& one) {
      return one.name == "quadratic_drag" && one.axis == axis;
    });
  };
  ASSERT_NE(drag("lat"), candidates.end());
  EXPECT_GT(drag("lat")->price, drag("")->price);
}

// Candidates of a slider under a vertical force.
std::vector<Candidate> candidates_under(double axial_load) {
  Hypothesis base;
  base.terms.push_back({{"flat_slider", "flat_slider", {}}, ""});
  NaturalScale scale = at_one_hertz(0.1 * axial_load, 0.01);
  scale.axial_load = axial_load;
  return candidates_of(kOnForce, base, scale, {0}, {scale}, {});
}

const Candidate* find(const std::vector<Candidate>& candidates, std::string_view name) {
  const auto found = std::find_if(candidates.begin(), candidates.end(),
                                  [&](const Candidate& one) { return one.name == name; });
  return found == candidates.end() ? nullptr : &*found;
}

TEST(CandidateTerms, AreOfferedUnderASmallVerticalForce) {
  const auto candidates = candidates_under(0.01);

  for (const char* name :
       {"mount_slack", "axial_load_strength", "axial_load_stiffness", "pressure_dep_sliding"})
    EXPECT_NE(find(candidates, name), nullptr) << name;
}

// The mean pressure is 50 MPa, so the factor at 50 MPa is a number near 1 for every slider.
TEST(CandidateTerms, HaveAContactAreaInProportionToTheLoad) {
  for (const double load : {50.0, 5e4, 5e7}) {
    const auto candidates = candidates_under(load);
    for (const char* name : {"pressure_dep_sliding", "pressure_tanh_sliding"}) {
      const Candidate* candidate = find(candidates, name);
      ASSERT_NE(candidate, nullptr) << name;
      for (const auto& [parameter, value] : candidate->adds[0].settings.parameters) {
        const double pressure = parameter == "contact_area" ? load / value : value;
        EXPECT_NEAR(pressure, 50e6, 1) << name << " " << parameter;
      }
    }
    EXPECT_NEAR(find(candidates, "pressure_tanh_sliding")->starts[0][1], 50e6, 1);
  }
}

// The specimen's force is kept between tested hypotheses.
TEST(CompositionSimulator, DistinguishesTheAxisOfATerm) {
  Record record;
  record.name = "sweep";
  record.time_step = 0.01;
  std::vector<double> motion;
  for (int i = 0; i < 500; ++i) motion.push_back(0.1 * std::sin(0.05 * i));
  for (const char* role : {"displacement.long", "displacement.lat", "force.long", "force.lat"}) {
    record.channels.emplace_back();
    record.channels.back().role = role;
    record.channels.back().values.assign(motion.begin(), motion.end());
  }
  const auto drive = motion_drive(record, {"displacement", "force"}, {0, 1}, {100, 0, 100});
  const auto force_of = [&](unsigned axes) {
    Hypothesis spring;
    spring.terms.push_back({{"asymmetric_stiffness", "spring", {{"stiffness", 1e6}}, axes}, ""});
    Eigen::MatrixXd force;
    std::vector<Eigen::MatrixXd> derivatives;
    EXPECT_TRUE(CompositionSimulator(spring, *drive, Predicted::Force, {0, 1})
                    .run({}, {}, force, derivatives));
    return force;
  };

  const Eigen::MatrixXd on_long = force_of(1), on_lat = force_of(2);

  EXPECT_GT(on_long.col(0).norm(), 0);
  EXPECT_EQ(on_long.col(1).norm(), 0);
  EXPECT_EQ(on_lat.col(0).norm(), 0);
  EXPECT_EQ(on_lat.col(1), on_long.col(0));
}

}  // namespace
}  // namespace rths::diagnosis

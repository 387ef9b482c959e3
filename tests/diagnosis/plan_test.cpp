// SPDX-License-Identifier: Apache-2.0
// The plan states what a diagnosis can find. The diagnosis itself and closed forms check it.
#include <rths/verdict/plan.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/report/diagnosis.hpp>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

using test_support::record_of;

// A guide: spring, damper and Dahl's friction.
Record guide(const std::string& name, Use use, unsigned seed, double friction) {
  double side = 0, before = 0;
  return record_of(name, use, seed, [=](double, double x, double v) mutable {
    const double way = x - before, direction = way > 0 ? 1 : -1;
    side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
    before = x;
    return 2e5 * x + 3e3 * v + friction * side;
  });
}

Case case_of(std::vector<Record> records) {
  Case c;
  c.name = "guide";
  c.records = std::move(records);
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = 200_000\n"
      "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 3_000\n"
      "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
      "model");
  for (const char* name :
       {"polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"})
    c.model.fitted.push_back({name, std::nullopt});
  return c;
}

Case with_friction(double friction) {
  return case_of({guide("fit", Use::Fit, 1, friction), guide("second", Use::HeldOut, 2, friction),
                  guide("unseen", Use::HeldOut, 3, friction)});
}

const Plan::Effect& effect(const Plan& plan, const std::string& name) {
  const auto& effects = plan.relations.back().effects;
  const auto found = std::find_if(effects.begin(), effects.end(),
                                  [&](const auto& one) { return one.name == name; });
  if (found == effects.end()) throw std::runtime_error{"no effect " + name};
  return *found;
}

bool has_limit(const std::vector<std::string>& limits, const std::string& start) {
  return std::any_of(limits.begin(), limits.end(),
                     [&](const std::string& limit) { return limit.starts_with(start); });
}

TEST(Plan, DoubtsTheSignOfAnOutputThatOpposesThePrediction) {
  const std::string doubt = "second: force.long opposes the prediction of the stated model (correl";
  Case c = with_friction(0);
  EXPECT_FALSE(has_limit(plan(c, {}).limits, doubt));

  for (auto& channel : c.records[1].channels)
    if (channel.role == "force.long")
      for (double& value : channel.values) value = -value;

  EXPECT_TRUE(has_limit(plan(c, {}).limits, doubt));
  EXPECT_FALSE(has_limit(plan(c, {}).limits, "fit: force.long opposes"));
  EXPECT_TRUE(has_limit(diagnose(c).limits, doubt));
}

TEST(Plan, SaysThatASectionAtRestIsTooShort) {
  Case c = with_friction(0);
  const std::string line = "quiet_s has 99 samples, expected at least 100 in all: it is not used.";
  for (auto& record : c.records) record.quiet = {0, 33};

  EXPECT_TRUE(has_limit(plan(c, {}).limits, line));
  c.records[0].quiet = {0, 34};
  EXPECT_FALSE(has_limit(plan(c, {}).limits, "quiet_s has"));
}

// Seconds since 1970.
TEST(Plan, ProposesASectionAtRestByTheClock) {
  Case c = with_friction(0);
  for (auto& record : c.records) {
    record.quiet.reset();
    record.start = 1.7e9;
  }

  const std::string remedy = plan(c, {}).noise.remedy;

  EXPECT_NE(remedy.find("quiet_s = [1700000000, 1700000002."), std::string::npos) << remedy;
}

TEST(Plan, SaysHowRecordsAreUsed) {
  const Plan plan = diagnosis::plan(with_friction(0));

  ASSERT_EQ(plan.records.size(), 3U);
  EXPECT_EQ(plan.records[0].role, "fits; scores in exchange; noise at rest");
  EXPECT_EQ(plan.records[2].role, "proof; noise at rest");
  EXPECT_NEAR(plan.records[0].duration, test_support::kLength, 1e-9);
  EXPECT_EQ(plan.relations.back().relation, "motion to force");
  EXPECT_TRUE(plan.noise.remedy.empty());
}

// Three times the size that the plan calls detectable is found, a third of it is not.
TEST(Plan, StatesTheSizeFromWhichFrictionIsFound) {
  const double size = effect(diagnosis::plan(with_friction(0)), "coulomb_friction").smallest;
  ASSERT_GT(size, 0);

  const Verdict large = diagnose(with_friction(3 * size));
  const Verdict small = diagnose(with_friction(size / 3));

  ASSERT_EQ(large.conclusion.outcome, Outcome::Missing) << 3 * size << " N: " << large.sentence;
  EXPECT_EQ(large.conclusion.causes[0].name, "coulomb_friction") << large.sentence;
  EXPECT_TRUE(small.conclusion.causes.empty()) << size / 3 << " N: " << small.sentence;
}

// In a sine of one frequency, the force of a mass is that of a spring: m x'' = -m w^2 x.
TEST(Plan, SeesNoInertiaInASineOfOneFrequencyBesideASpring) {
  Record sine = guide("sine", Use::Fit, 1, 0);
  const double w = 2 * std::numbers::pi * 0.75;
  const auto noisy = sine.channels;
  for (std::size_t i = 0; i < sine.samples(); ++i) {
    const double t = static_cast<double>(i) * sine.time_step;
    const double x = 0.05 * std::sin(w * t), v = 0.05 * w * std::cos(w * t);
    sine.channels[0].values[i] = x;
    sine.channels[1].values[i] = 2e5 * x + 3e3 * v;
  }
  // The noise of another record, at rest.
  Record rest = guide("rest", Use::Reference, 4, 0);
  const auto quiet = rest.quiet->second;
  for (auto& channel : rest.channels) channel.values.resize(quiet);
  rest.quiet = {0, quiet};
  sine.quiet.reset();

  const double alone = effect(diagnosis::plan(case_of({sine, rest})), "platen_inertia").information;
  const double rich = effect(diagnosis::plan(with_friction(0)), "platen_inertia").information;

  EXPECT_LT(alone, kDetectable);
  EXPECT_GT(rich, 100 * kDetectable);
}

// Friction that differs forwards and backwards contains friction, and an offset is free.
TEST(Plan, NamesPairsThatTheMotionCannotTellApart) {
  const Plan plan = diagnosis::plan(with_friction(0));
  const auto& confusions = plan.relations.back().confusions;

  for (const auto& confusion : confusions) {
    EXPECT_LT(confusion.left, kDistinguishable);
    EXPECT_GE(confusion.share, 0);
    EXPECT_LE(confusion.share, 1);
    EXPECT_FALSE(confusion.effect == "coulomb_friction at force" &&
                 confusion.rival == "asymmetric_friction at force");
  }
  const std::string text = report::plan_summary(plan);
  EXPECT_EQ(text.rfind("case      guide, model of kind 'platen'\n", 0), 0U) << text;
  EXPECT_NE(text.find("search    machine: "), std::string::npos) << text;
  EXPECT_NE(text.find("\ncost      "), std::string::npos) << text;
  EXPECT_GT(plan.relations.back().cost.values, 0);
  EXPECT_GT(plan.relations.back().cost.longest, plan.relations.back().cost.shortest);
}

TEST(Plan, OffersAMeasurementOfTheNoise) {
  Case c = with_friction(0);
  for (auto& record : c.records) record.quiet.reset();

  EXPECT_NE(diagnosis::plan(c).noise.remedy.find("quiet_s = [0, "), std::string::npos);
}

// The displacement is at rest for two seconds, but the force grows in the second one: a case with
// all of this section as quiet_s would be refused.
TEST(Plan, OffersNoSectionAtRestInWhichAForceMoves) {
  Case c = with_friction(0);
  for (auto& record : c.records) {
    record.quiet.reset();
    for (auto& channel : record.channels)
      for (std::size_t i = 250; i < 500 && channel.role == "force.long"; ++i)
        channel.values[i] += 400.0 * static_cast<double>(i - 250);
  }

  const std::string remedy = diagnosis::plan(c).noise.remedy;

  const std::string begin = "quiet_s = [0, ";
  const auto at = remedy.find(begin);
  ASSERT_NE(at, std::string::npos) << remedy;
  EXPECT_LT(std::stod(remedy.substr(at + begin.size())), 1.3);
}

// Only the motion of the one pressure that is held out first would score a law of the pressure.
TEST(Plan, SaysThatAStateIsNotDetermined) {
  Case c = with_friction(0);
  for (std::size_t i = 0; i < c.records.size(); ++i)
    c.records[i].channels.push_back(
        {"auxiliary.pressure", "Pa",
         std::vector<double>(c.records[i].samples(), 1e5 * static_cast<double>(i + 1))});

  EXPECT_TRUE(has_limit(diagnosis::plan(c).limits, "auxiliary.pressure hardly varies in some"));
}

}  // namespace
}  // namespace rths::diagnosis

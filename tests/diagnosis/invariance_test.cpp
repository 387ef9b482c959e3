// SPDX-License-Identifier: Apache-2.0
//
// A verdict depends on the test alone: not on units, on the sign of an axis, on names, or on the
// sampling rate.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kStiffness = 2e5, kDamping = 3e3;  // [N/m], [N·s/m]

/// Friction of 300 N, or a force that is periodic in the displacement, in the given unit of force.
enum class Hidden { Friction, Cogging };

Record record_of(const std::string& name, Use use, unsigned seed, Hidden hidden) {
  double side = 0, before = 0;
  return test_support::record_of(
      name, use, seed,
      [&](double, double x, double v) {
        const double way = x - before, direction = way > 0 ? 1 : -1;
        side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
        before = x;
        const double effect = hidden == Hidden::Friction
                                  ? 300 * side
                                  : 300 * std::sin(2 * std::numbers::pi * x / 0.02);
        return kStiffness * x + kDamping * v + effect;
      },
      {.length = test_support::kShortLength});
}

/// @param force, length  SI units per unit of the case
Case case_of(Hidden hidden, double force = 1, double length = 1) {
  Case c;
  c.name = "guide";
  c.records = {record_of("fit", Use::Fit, 1, hidden), record_of("second", Use::HeldOut, 2, hidden),
               record_of("unseen", Use::HeldOut, 3, hidden)};
  for (auto& record : c.records)
    for (auto& channel : record.channels)
      for (double& value : channel.values) value /= channel.unit == "N" ? force : length;
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      fmt::format("[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = {}\n"
                  "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = {}\n"
                  "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
                  2.1e5 * length / force, 2.5e3 * length / force),
      "model");
  for (const char* name :
       {"polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"})
    c.model.fitted.push_back({name, std::nullopt});
  return c;
}

void expect_friction(const Verdict& verdict, double force) {
  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, "coulomb_friction");
  EXPECT_NEAR(verdict.conclusion.causes[0].parameters[0].value, 300 / force, 6 / force);
}

TEST(Invariance, FrictionIsNamedInAnyUnitOfForce) {
  for (const double unit : {1e-3, 1e3}) {
    SCOPED_TRACE(unit);
    expect_friction(diagnose(case_of(Hidden::Friction, unit)), unit);
  }
}

TEST(Invariance, FrictionIsNamedInAnyUnitOfLength) {
  for (const double unit : {1e-2, 1e2}) {
    SCOPED_TRACE(unit);
    expect_friction(diagnose(case_of(Hidden::Friction, 1, unit)), 1);
  }
}

// Without cogging in the catalogue, its form is periodic in displacement, by the same share.
TEST(Invariance, AFormIsDescribedAlikeInAnyUnitOfForce) {
  DiagnosisOptions options;
  options.without = {"cogging"};
  double share = 0;
  for (const double unit : {1.0, 1e-3, 1e6}) {
    SCOPED_TRACE(unit);
    const Verdict verdict = diagnose(case_of(Hidden::Cogging, unit), options);
    ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
    ASSERT_FALSE(verdict.descriptions.empty());
    EXPECT_EQ(verdict.descriptions[0].form, "periodic in displacement");
    EXPECT_GT(verdict.descriptions[0].share, 0.95);
    if (share == 0) share = verdict.descriptions[0].share;
    EXPECT_NEAR(verdict.descriptions[0].share, share, 0.01);
  }
}

TEST(Invariance, FrictionIsNamedIfTheAxisPointsTheOtherWay) {
  Case c = case_of(Hidden::Friction);
  for (auto& record : c.records)
    for (auto& channel : record.channels)
      for (double& value : channel.values) value = -value;
  expect_friction(diagnose(c), 1);
}

TEST(Invariance, NamesOfRecordsDoNotMatter) {
  Case c = case_of(Hidden::Friction);
  const Verdict before = diagnose(c);
  for (auto& record : c.records) record.name = "z " + record.name;
  const Verdict after = diagnose(c);
  expect_friction(after, 1);
  EXPECT_EQ(after.conclusion.causes[0].parameters[0].value,
            before.conclusion.causes[0].parameters[0].value);
}

// Every other sample, of a signal far below the new Nyquist frequency.
TEST(Invariance, FrictionIsNamedAtHalfTheSamplingRate) {
  Case c = case_of(Hidden::Friction);
  for (auto& record : c.records) {
    for (auto& channel : record.channels) {
      std::vector<double> values;
      for (std::size_t i = 0; i < channel.values.size(); i += 2)
        values.push_back(channel.values[i]);
      channel.values = std::move(values);
    }
    record.time_step *= 2;
    if (record.quiet) record.quiet->second /= 2;
  }
  expect_friction(diagnose(c), 1);
}

TEST(Invariance, OneRecordMoreChangesNoName) {
  Case c = case_of(Hidden::Friction);
  c.records.push_back(record_of("fourth", Use::Fit, 4, Hidden::Friction));
  expect_friction(diagnose(c), 1);
}

}  // namespace
}  // namespace rths::diagnosis

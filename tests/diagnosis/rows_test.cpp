// SPDX-License-Identifier: Apache-2.0
// Quasi-static tests: rows without time, or with a made-up rate.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

namespace rths::diagnosis {
namespace {

// A bilinear loop of 10 and 1 kN/mm that yields at 20 kN, in half-cycles of growing amplitude with
// 3 to 25 rows.
Record coarse_record(const std::string& name, Use use, unsigned seed, double rate) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = rate > 0 ? 1 / rate : 1;
  record.has_time = rate > 0;
  record.start = rate > 0 ? 0 : 1;
  Channel u{"displacement.long", "m", {0}}, f{"force.long", "N", {0}};
  double slider = 0;  // displacement of the yielding part
  for (int half = 0; half < 40; ++half) {
    const double from = u.values.back();
    const double to = (half % 2 == 0 ? 1 : -1) * (5e-3 + 5e-4 * half);
    const int rows = 3 + static_cast<int>(random() % 23);
    for (int i = 1; i <= rows; ++i) {
      const double x = from + (to - from) * i / rows;
      slider = std::clamp(slider, x - 2e-3, x + 2e-3);
      u.values.push_back(x);
      f.values.push_back(1e6 * x + 9e6 * (x - slider) + 50 * normal(random));
    }
  }
  record.channels = {u, f};
  return record;
}

// @param rate  of the rows [Hz]; 0: without time
Verdict verdict_at(double rate) {
  Case c;
  c.name = "coarse rows";
  c.records = {coarse_record("fit", Use::Fit, 1, rate),
               coarse_record("second", Use::HeldOut, 2, rate),
               coarse_record("unseen", Use::HeldOut, 3, rate)};
  c.model.kind = ModelKind::Bearing;
  c.model.table = Config::parse("[polynomial_stiffness]\nlinear_N_per_m = 2e6\n", "model");
  c.model.fitted = {{"polynomial_stiffness.linear", std::nullopt}};
  c.noise = {{"force.long", 50}, {"displacement.long", 1e-7}};
  return diagnose(c);
}

// The same loop with three rows in each half-cycle, whose noise is not stated.
Verdict coarsest_at(double rate) {
  Case c;
  c.name = "coarsest rows";
  for (const unsigned seed : {1U, 2U, 3U}) {
    Record record = coarse_record("record " + std::to_string(seed),
                                  seed == 1 ? Use::Fit : Use::HeldOut, seed, rate);
    for (Channel& channel : record.channels) {
      std::vector<double> few;
      for (std::size_t i = 0; i < channel.values.size(); i += 4) few.push_back(channel.values[i]);
      channel.values = few;
    }
    c.records.push_back(record);
  }
  c.model.kind = ModelKind::Bearing;
  c.model.table = Config::parse("[polynomial_stiffness]\nlinear_N_per_m = 2e6\n", "model");
  c.model.fitted = {{"polynomial_stiffness.linear", std::nullopt}};
  return diagnose(c);
}

std::vector<std::string> names_at(double rate) {
  std::vector<std::string> names;
  for (const auto& cause : verdict_at(rate).conclusion.causes) names.push_back(cause.name);
  return names;
}

TEST(RowsWithoutTime, ShowABilinearLoop) {
  const Verdict verdict = verdict_at(0);

  ASSERT_FALSE(verdict.conclusion.causes.empty()) << verdict.sentence;
  const Cause& cause = verdict.conclusion.causes[0];
  EXPECT_EQ(cause.name, "bouc_wen") << verdict.sentence;
  EXPECT_NEAR(cause.parameters[0].value, 18e3, 500);
  EXPECT_NEAR(cause.parameters[1].value, 2e-3, 1e-4);
  EXPECT_TRUE(verdict.conclusion.where.bands.empty());
  EXPECT_EQ(verdict.sentence.find(" Hz"), std::string::npos) << verdict.sentence;
  EXPECT_EQ(verdict.sentence.find(" s "), std::string::npos) << verdict.sentence;
  EXPECT_NE(verdict.sentence.find("the stated noise"), std::string::npos) << verdict.sentence;
  EXPECT_EQ(verdict.sentence.find("guessed"), std::string::npos) << verdict.sentence;
  for (const auto& name : verdict.terms.searched)
    EXPECT_TRUE(name != "viscous_friction" && name != "viscoelastic_relaxation") << name;
}

TEST(RowsWithAMadeUpRate, HaveTheSameNamesAtEachRate) {
  const auto names = names_at(0);

  for (const double rate : {1.0, 8.0, 100.0}) EXPECT_EQ(names_at(rate), names) << rate;
}

TEST(RowsWithAMadeUpRate, HaveNoVelocityIfTheyAreTooCoarse) {
  const Verdict none = coarsest_at(0), slow = coarsest_at(1), fast = coarsest_at(100);

  for (const Verdict* verdict : {&slow, &fast}) {
    EXPECT_EQ(verdict->sentence, none.sentence);
    EXPECT_TRUE(std::any_of(verdict->limits.begin(), verdict->limits.end(), [](const auto& limit) {
      return limit.find("too few rows in a cycle") != std::string::npos;
    }));
    EXPECT_EQ(std::count(verdict->terms.searched.begin(), verdict->terms.searched.end(),
                         "viscoelastic_relaxation"),
              0);
  }
}

}  // namespace
}  // namespace rths::diagnosis

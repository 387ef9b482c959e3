// SPDX-License-Identifier: Apache-2.0
// The simulation's rule of hysteresis may be wrong. The diagnosis then names the right rule, and
// finds other missing terms as with a right rule.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

struct Loop {
  double strength = 4e4, yield = 0.008;  // [N], [m]
  double beta = 0.5, slip = 0;           // [-], [m]
};

struct Bearing {
  Loop loop{};
  Loop second{0, 0.04, 0.5, 0};
  double friction = 0;  // [N]
};

// Bouc and Wen's law for one axis with Baber and Noori's slip, integrated by Heun's method.
class Walked {
 public:
  explicit Walked(const Loop& loop) : loop_{loop} {}

  double force(double way) {
    constexpr int kParts = 10;
    for (int i = 0; i < kParts; ++i) {
      const double du = way / kParts, first = rate(z_, du) * du;
      z_ += 0.5 * (first + rate(z_ + first, du) * du);
    }
    return loop_.strength * z_;
  }

 private:
  [[nodiscard]] double rate(double z, double du) const {
    constexpr double kWidth = 0.2;
    const double m = 1 - z * z * (1 - loop_.beta + (z * du > 0 ? loop_.beta : -loop_.beta));
    const double lock = loop_.slip * std::sqrt(2 / std::numbers::pi) / kWidth *
                        std::exp(-0.5 * z * z / (kWidth * kWidth));
    return m / (loop_.yield + lock * m);
  }

  Loop loop_;
  double z_ = 0;
};

Record record_of(const std::string& name, Use use, unsigned seed, const Bearing& bearing) {
  Walked first{bearing.loop}, second{bearing.second};
  double before = 0, side = 0;
  const auto force = [&](double, double x, double) {
    const double way = x - before, direction = way > 0 ? 1 : -1;
    before = x;
    side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
    return 2e5 * x + first.force(way) + second.force(way) + bearing.friction * side;
  };
  return test_support::record_of(name, use, seed, force, {.length = test_support::kShortLength});
}

Verdict verdict_of(const Bearing& bearing) {
  Case c;
  c.name = "bearing";
  c.records = {record_of("fit", Use::Fit, 1, bearing),
               record_of("second", Use::HeldOut, 2, bearing),
               record_of("unseen", Use::HeldOut, 3, bearing)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[bouc_wen]\ncharacteristic_strength_N = 42_000\npost_yield_stiffness_N_per_m = 210_000\n"
      "yield_displacement_m = 0.009\n"
      "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
      "model");
  for (const char* name : {"bouc_wen.characteristic_strength", "bouc_wen.post_yield_stiffness",
                           "bouc_wen.yield_displacement", "bouc_wen.eta", "force_offset.offset"})
    c.model.fitted.push_back({name, std::nullopt});
  return diagnose(c);
}

std::vector<std::string> names_of(const Verdict& verdict) {
  std::vector<std::string> names;
  for (const auto& cause : verdict.conclusion.causes) names.push_back(cause.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Rule, IsAcceptedIfItIsRight) {
  EXPECT_EQ(names_of(verdict_of({})), Names{});
  EXPECT_EQ(names_of(verdict_of({.friction = 400})), Names{"coulomb_friction"});
}

TEST(Rule, OfUnloadingIsFoundTogetherWithFriction) {
  const Verdict verdict = verdict_of({.loop = {.beta = 0.2}, .friction = 400});

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  ASSERT_EQ(names_of(verdict), (Names{"coulomb_friction", "unloading_rule"})) << verdict.sentence;
  EXPECT_FALSE(verdict.conclusion.causes[0].is_rule);
  EXPECT_TRUE(verdict.conclusion.causes[1].is_rule);
  EXPECT_NEAR(verdict.conclusion.causes[0].parameters[0].value, 400, 10);
  EXPECT_NEAR(verdict.conclusion.causes[1].parameters[0].value, 0.2, 0.01);
  EXPECT_EQ(verdict.conclusion.where.part, Part::Machine);
  EXPECT_LT(verdict.evaluation.fit.back().nrmse_after,
            1.2 * verdict.evaluation.fit.back().noise_floor);
  EXPECT_NE(verdict.improvement.fragment.find("[specimen.bouc_wen]"), std::string::npos)
      << verdict.improvement.fragment;
  EXPECT_NE(verdict.improvement.fragment.find("\nbeta = 0."), std::string::npos)
      << verdict.improvement.fragment;
}

TEST(Rule, OfTwoLoopsIsASecondTermOfTheModel) {
  const Verdict verdict = verdict_of({.second = {.strength = 2e4, .yield = 0.04}});

  ASSERT_EQ(names_of(verdict), Names{"second_loop"}) << verdict.sentence;
  EXPECT_TRUE(verdict.conclusion.causes[0].is_rule);
  EXPECT_EQ(verdict.conclusion.where.part, Part::Bearing);
  EXPECT_NE(verdict.improvement.fragment.find("[specimen.second_loop]\nkind = \"bouc_wen\""),
            std::string::npos)
      << verdict.improvement.fragment;
}

TEST(Rule, WithSlipReplacesTheFirstOne) {
  const Verdict verdict = verdict_of({.loop = {.slip = 0.01}});

  ASSERT_EQ(names_of(verdict), Names{"bouc_wen_slip"}) << verdict.sentence;
  EXPECT_NEAR(verdict.conclusion.causes[0].parameters[0].value, 0.01, 5e-4);
  EXPECT_NE(verdict.improvement.fragment.find("[specimen.bouc_wen]\nkind = \"bouc_wen_slip\""),
            std::string::npos)
      << verdict.improvement.fragment;
}

}  // namespace
}  // namespace rths::diagnosis

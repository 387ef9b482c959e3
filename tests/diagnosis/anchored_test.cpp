// SPDX-License-Identifier: Apache-2.0
// The user's own simulation has coarse steps. Its output anchors the model of this project, so that
// the errors of these steps are not named as physics.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "dynamic_case.hpp"
#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

std::vector<std::string> names_of(const Verdict& verdict) {
  std::vector<std::string> names;
  for (const auto& cause : verdict.conclusion.causes) names.push_back(cause.name);
  return names;
}

void expect_floor(const Verdict& verdict) {
  const RecordScore& proof = verdict.evaluation.fit.back();
  EXPECT_LT(proof.nrmse_after, 1.25 * proof.noise_floor) << verdict.sentence;
}

constexpr double kSampling = 0.005, kMass = 2, kDamping = 16, kStiffness = 4000;

// A mass on a spring by Newmark's method, one step per sample: the period is 0.4 % too long.
std::vector<double> newmark(const std::vector<double>& push, double cubic) {
  constexpr int kIterations = 30;
  std::vector<double> motion;
  double x = 0, v = 0, a = 0;
  for (const double u : push) {
    const double x0 = x + kSampling * v + kSampling * kSampling / 4 * a, v0 = v + kSampling / 2 * a;
    for (int i = 0; i < kIterations; ++i) {
      x = x0 + kSampling * kSampling / 4 * a;
      v = v0 + kSampling / 2 * a;
      const double missing = u - kDamping * v - kStiffness * x - cubic * x * x * x - kMass * a;
      a += missing / (kMass + kDamping * kSampling / 2 + kStiffness * kSampling * kSampling / 4);
    }
    x = x0 + kSampling * kSampling / 4 * a;
    v = v0 + kSampling / 2 * a;
    motion.push_back(x);
  }
  return motion;
}

Verdict verdict_on_mass(double cubic, const std::string& anchor) {
  constexpr std::size_t kSamples = 1600, kRest = 400;
  test_support::CaseFolder folder;
  std::string toml = "format = 1\n";
  for (unsigned k = 0; k < 3; ++k) {
    auto push = test_support::random_signal(10 + k, kSamples, kSampling, 0.5, 12, 20);
    std::fill_n(push.begin(), kRest, 0.0);
    const auto simulated = newmark(push, 0), true_motion = newmark(push, cubic);
    auto measured = test_support::noise(100 + k, kSamples, 3e-5);
    for (std::size_t i = 0; i < kSamples; ++i) measured[i] += true_motion[i];
    const std::string file = "run" + std::to_string(k) + ".csv";
    folder.write(file, {{"u", push}, {"y", measured}, {"simulated", simulated}});
    toml += "[[record]]\nfile = \"" + file + "\"\nquiet_s = [0, 1.9]\nuse = \"" +
            (k == 0 ? "fit" : "held_out") + "\"\n";
  }
  return diagnose(folder.load(toml + R"([channels]
rate_Hz = 200
input.u = "u [N]"
output.y = "y [m]"
)" + anchor + R"(
[model]
kind = "mass_spring_damper"
masses_kg = [2]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 4000
damping_N_s_per_m = 16
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.y" = "displacement.1"
)"));
}

constexpr const char* kAnchor = "predicted.output.y = \"simulated [m]\"";

TEST(Anchor, KeepsStepsOfTheUsersSimulationFromBeingNamed) {
  EXPECT_NE(names_of(verdict_on_mass(0, "")), std::vector<std::string>{});

  const Verdict verdict = verdict_on_mass(0, kAnchor);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::None) << verdict.sentence;
  expect_floor(verdict);
}

TEST(Anchor, LeavesTheRightNameAlone) {
  const Verdict verdict = verdict_on_mass(1e5, kAnchor);

  EXPECT_EQ(names_of(verdict), std::vector<std::string>{"cubic_stiffness"}) << verdict.sentence;
  expect_floor(verdict);
}

// A hysteretic bearing by Euler's method, one step per sample.
class EulerBearing {
 public:
  double operator()(double x) {
    constexpr double kStrength = 4e4, kYield = 0.008, kStiff = 2e5;
    const double way = x - before_;
    before_ = x;
    z_ += way / kYield * (1 - z_ * z_ * (z_ * way > 0 ? 1 : 0));
    return kStiff * x + kStrength * z_;
  }

 private:
  double before_ = 0, z_ = 0;
};

// A record of the bearing with friction, and the user's simulation of it without.
Record record_of(const std::string& name, Use use, unsigned seed, double friction, bool anchors) {
  EulerBearing bearing;
  double before = 0, side = 0;
  Channel predicted{"predicted.force.long", "N", {}};
  const auto force = [&](double, double x, double) {
    const double way = x - before, direction = way > 0 ? 1 : -1;
    before = x;
    side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
    predicted.values.push_back(bearing(x));
    return predicted.values.back() + friction * side;
  };
  Record record =
      test_support::record_of(name, use, seed, force, {.length = test_support::kShortLength});
  if (anchors) record.channels.push_back(predicted);
  return record;
}

Verdict verdict_on_bearing(double friction, bool anchors) {
  Case c;
  c.name = "bearing";
  c.records = {record_of("fit", Use::Fit, 1, friction, anchors),
               record_of("second", Use::HeldOut, 2, friction, anchors),
               record_of("unseen", Use::HeldOut, 3, friction, anchors)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[bouc_wen]\ncharacteristic_strength_N = 40_000\npost_yield_stiffness_N_per_m = 200_000\n"
      "yield_displacement_m = 0.008\n"
      "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
      "model");
  c.model.fitted.push_back({"force_offset.offset", std::nullopt});
  return diagnose(c);
}

TEST(Anchor, ServesCompositionsDrivenByAMeasuredMotion) {
  EXPECT_NE(verdict_on_bearing(0, false).conclusion.outcome, Outcome::None);

  const Verdict silent = verdict_on_bearing(0, true);
  const Verdict named = verdict_on_bearing(400, true);

  EXPECT_EQ(silent.conclusion.outcome, Outcome::None) << silent.sentence;
  EXPECT_EQ(names_of(named), std::vector<std::string>{"coulomb_friction"}) << named.sentence;
  expect_floor(silent);
  expect_floor(named);
}

TEST(Anchor, IsNeededInEachRecord) {
  const auto mixed = [] {
    Case c;
    c.records = {record_of("fit", Use::Fit, 1, 0, true),
                 record_of("unseen", Use::HeldOut, 3, 0, false)};
    c.model.kind = ModelKind::Platen;
    c.model.table = Config::parse("[linear_spring]\nkind = \"bouc_wen\"\n", "model");
    static_cast<void>(diagnose(c));
  };

  EXPECT_EQ(test::error_of(mixed),
            "unseen: has no channel predicted.force.long, which anchors the model");
}

}  // namespace
}  // namespace rths::diagnosis

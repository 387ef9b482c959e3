// SPDX-License-Identifier: Apache-2.0
//
// The form of an effect without a name in a free run. The recordings come from an integrator that
// shares no code with the library. A function of the measured output would explain itself: a drag
// was once described as f(u).
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "dynamic_truth.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kInterval = 0.005;
constexpr std::size_t kCount = 2400, kStill = 400;
constexpr const char* kRecordings[] = {"fit.csv", "second.csv", "third.csv"};
const std::vector<std::string> kWithout{"quadratic_drag",
                                        "viscous_friction",
                                        "asymmetric_viscous",
                                        "coulomb_friction",
                                        "asymmetric_friction",
                                        "stribeck_friction",
                                        "piecewise_damping",
                                        "bouc_wen",
                                        "cubic_stiffness",
                                        "piecewise_stiffness",
                                        "gap_contact",
                                        "large_strain_stiffening",
                                        "asymmetric_stiffness",
                                        "input_dead_zone",
                                        "transducer_backlash",
                                        "power_damping",
                                        "velocity_dependent_friction"};

// The verdict on a mass on a spring with an additional force of displacement and velocity.
Verdict verdict_on(const std::function<double(double, double)>& force) {
  test_support::Truth truth;
  truth.masses = VectorXd::Constant(1, 2);
  truth.stiffness = VectorXd::Constant(1, 4000);
  truth.damping = VectorXd::Constant(1, 6);
  truth.spring = [&](Index, double d, double v) { return force(d, v); };
  const test_support::CaseFolder folder;
  std::string toml = "format = 1\n";
  for (unsigned k = 0; k < std::size(kRecordings); ++k) {
    auto u = test_support::random_signal(10 + k, kCount, kInterval, 0.5, 12, 20);
    std::fill_n(u.begin(), kStill, 0.0);
    const VectorXd y = test_support::motion_of(truth, u, kInterval).col(0);
    auto measured =
        test_support::noise(100 * k, kCount, 0.003 * std::sqrt(y.squaredNorm() / kCount));
    for (std::size_t i = 0; i < kCount; ++i) measured[i] += y[static_cast<Index>(i)];
    folder.write(kRecordings[k], {{"u", u}, {"y", measured}});
    toml += fmt::format("[[record]]\nfile = \"{}\"\nuse = \"{}\"\nquiet_s = [0, {}]\n",
                        kRecordings[k], k == 0 ? "fit" : "held_out", (kStill - 5) * kInterval);
  }
  DiagnosisOptions options;
  options.without = kWithout;
  return diagnose(folder.load(toml + R"([channels]
rate_Hz = 200
input.u = "u [N]"
output.y = "y [m]"
[model]
kind = "mass_spring_damper"
masses_kg = [2.0]
fitted = ["spring.1.stiffness", "spring.1.damping"]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 4100
damping_N_s_per_m = 5
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.y" = "displacement.1"
)"),
                  options);
}

void expect_form(const Verdict& verdict, const std::string& form) {
  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
  ASSERT_FALSE(verdict.descriptions.empty());
  const Description& best = verdict.descriptions[0];
  std::string all;
  for (const auto& one : verdict.descriptions)
    all += fmt::format("{} {:.3f}; ", one.form, one.share);
  SCOPED_TRACE(all + verdict.sentence);
  EXPECT_EQ(best.form, form + " between mass 1 and the ground");
  EXPECT_GT(best.share, 0.9);
  EXPECT_LE(best.share, 1.05);
}

TEST(FreeForm, OfADragIsAFunctionOfVelocity) {
  expect_form(verdict_on([](double, double v) { return 15 * std::abs(v) * v; }), "f(v)");
}

TEST(FreeForm, OfAStiffeningSpringIsAFunctionOfDisplacement) {
  expect_form(verdict_on([](double d, double) { return 2e3 * (d - std::clamp(d, -0.005, 0.005)); }),
              "f(u)");
}

TEST(FreeForm, OfADuffingOscillatorIsAFunctionOfDisplacement) {
  expect_form(verdict_on([](double d, double) { return 4e5 * d * d * d; }), "f(u)");
}

TEST(FreeForm, OfACoggingForceIsPeriodicInDisplacement) {
  expect_form(
      verdict_on([](double d, double) { return 5 * std::sin(2 * std::numbers::pi * d / 0.02); }),
      "periodic in displacement");
}

}  // namespace
}  // namespace rths::diagnosis

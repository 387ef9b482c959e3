// SPDX-License-Identifier: Apache-2.0
// Laws that a simulation lacks, and that stand for special cases in the model's own terms.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/core/text.hpp>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

using test_support::Specimen;

// A specimen for each record, so that one with a memory begins at rest.
using Maker = std::function<Specimen()>;

Verdict verdict_on(const Maker& maker, const std::string& model,
                   const std::vector<std::string>& fitted,
                   const std::vector<std::string>& without = {}) {
  Case c;
  c.name = "one axis";
  const auto record = [&](const char* name, Use use, unsigned seed) {
    return test_support::record_of(name, use, seed, maker(),
                                   {.length = test_support::kShortLength});
  };
  c.records = {record("fit", Use::Fit, 1), record("second", Use::HeldOut, 2),
               record("unseen", Use::HeldOut, 3)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(model + "[offset]\naxes = [\"long\"]\noffset_N = 0\n", "model");
  c.model.fitted.push_back({"offset.offset", std::nullopt});
  for (const auto& name : fitted) c.model.fitted.push_back({name, std::nullopt});
  DiagnosisOptions options;
  options.without = without;
  return diagnose(c, options);
}

const Cause* cause_in(const Verdict& verdict, const std::string& name) {
  const auto& causes = verdict.conclusion.causes;
  const auto found = std::find_if(causes.begin(), causes.end(),
                                  [&](const Cause& cause) { return cause.name == name; });
  return found == causes.end() ? nullptr : &*found;
}

const std::string kViscous = "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 4e3\n";
const std::string kLinear = "[linear_stiffness]\naxes = [\"long\"]\nstiffness_N_per_m = 4e4\n";

TEST(PowerOfVelocity, ReplacesTheViscousFrictionOfTheModel) {
  const Verdict verdict = verdict_on(
      [] {
        return [](double, double, double v) {
          return 3000 * std::copysign(std::pow(v * v + 1e-6, 0.225), v) *
                 std::min(1.0, std::abs(v) / 1e-3);
        };
      },
      kViscous, {"viscous_friction.coefficient"});

  const Cause* law = cause_in(verdict, "power_damping");
  ASSERT_NE(law, nullptr) << verdict.sentence;
  EXPECT_NEAR(law->parameters[1].value, 0.45, 0.02) << verdict.sentence;
  EXPECT_EQ(verdict.evaluation.refitted[0].after, 0) << verdict.sentence;
}

TEST(PiecewiseSpring, IsFoundUnderMeasuredMotion) {
  const Verdict verdict = verdict_on(
      [] {
        return [](double, double u, double) { return 2e4 * u + 6e4 * std::clamp(u, -0.03, 0.03); };
      },
      kLinear, {"linear_stiffness.stiffness"});

  const Cause* spring = cause_in(verdict, "piecewise_stiffness");
  ASSERT_NE(spring, nullptr) << verdict.sentence;
  EXPECT_NEAR(spring->parameters[0].value, 6e4, 1e3) << verdict.sentence;
  EXPECT_NEAR(spring->parameters[1].value, 0.03, 1e-3) << verdict.sentence;
}

}  // namespace
}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
// Recordings of laboratories, each with a simple model. The diagnosis names the missing term, finds
// its published size and confirms it on a record that was not fitted. Without that term in the
// catalogue, the verdict is "unknown" and describes the variables that the residual depends on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <gtest/gtest.h>

#include <rths/cases/case.hpp>
#include <rths/verdict/diagnose.hpp>

#include "support/files.hpp"
#include "support/readable.hpp"

namespace rths::diagnosis {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class RealData : public testing::Test {
 protected:
  // Reads the case tests/diagnosis/real/<name>; skips the test if its recordings are missing.
  void open(const std::string& name) {
    recording_ = name;
    if (!fs::exists(test::source_tree() / "../shared/data"))
      GTEST_SKIP() << "SKIPPED: there is no ../shared/data with the recordings of " << name;
    case_ = load_case(test::source_tree() / "tests/diagnosis/real" / name);
  }
  [[nodiscard]] Verdict diagnosed(const Names& without = {}) const {
    DiagnosisOptions options;
    options.without = without;
    const Verdict verdict = diagnose(case_, options);
    record(verdict, without);
    const Answers answers = answers_of(verdict);
    EXPECT_EQ(
        test::unreadable(answers.headline, {answers.missing, answers.certainty, answers.next}), "");
    std::printf("  %s\n  %.1f s\n", answers.headline.c_str(), verdict.seconds);
    return verdict;
  }
  // Over all held-out records, weighted with the energy of their measured signals.
  [[nodiscard]] double held_out(const Verdict& verdict, double RecordScore::*error) const {
    double errors = 0, all = 0;
    for (const auto& score : verdict.evaluation.fit) {
      if (score.use != "held_out") continue;
      const auto record = std::find_if(case_.records.begin(), case_.records.end(),
                                       [&](const Record& r) { return r.name == score.record; });
      const double energy = energy_of(*record);
      errors += std::pow(score.*error, 2) * energy;
      all += energy;
    }
    return std::sqrt(errors / all);
  }
  void print_refit(const Verdict& verdict) const {
    std::printf("  stated %.3f, fitted without %.3f, with %.4f\n",
                held_out(verdict, &RecordScore::nrmse_stated),
                held_out(verdict, &RecordScore::nrmse_before),
                held_out(verdict, &RecordScore::nrmse_after));
    for (const auto& p : verdict.evaluation.refitted)
      std::printf("  %-40s %.6g without, %.6g with %s\n", p.name.c_str(), p.before, p.after,
                  p.unit.c_str());
  }

  Case case_;
  std::string recording_;

 private:
  // Properties of the test, for benchmarks/keep.py.
  void record(const Verdict& verdict, const Names& without) const {
    const auto property = [](const std::string& name, double value) {
      std::ostringstream text;
      text << value;
      RecordProperty(name, text.str());
    };
    RecordProperty("recording", recording_);
    RecordProperty("without", without.empty() ? "" : without.front());
    RecordProperty("outcome", name_of(verdict.conclusion.outcome));
    RecordProperty("sentence", verdict.sentence);
    // The last held-out record is the one that the verdict's sentence calls unseen.
    const auto unseen = std::find_if(verdict.evaluation.fit.rbegin(), verdict.evaluation.fit.rend(),
                                     [](const auto& score) { return score.use == "held_out"; });
    ASSERT_NE(unseen, verdict.evaluation.fit.rend());
    property("nrmse_stated", unseen->nrmse_stated);
    property("nrmse_before", unseen->nrmse_before);
    property("nrmse_after", unseen->nrmse_after);
    property("noise_floor", unseen->noise_floor);
    for (const auto& cause : verdict.conclusion.causes)
      for (const auto& parameter : cause.parameters) {
        property(parameter.name, parameter.value);
        property(parameter.name + ".half_width", (parameter.high - parameter.low) / 2);
      }
    for (const auto& parameter : verdict.evaluation.refitted) {
      property(parameter.name + ".before", parameter.before);
      property(parameter.name + ".after", parameter.after);
    }
    if (!verdict.descriptions.empty()) RecordProperty("description", verdict.descriptions[0].form);
  }
  // Of the predicted channel, without its mean.
  static double energy_of(const Record& record) {
    const Channel* channel = nullptr;
    for (const char* role : {"force.long", "displacement.long", "output.y"})
      if (channel == nullptr) channel = record.find(role);
    double sum = 0, squares = 0;
    for (const double value : channel->values) sum += value, squares += value * value;
    return squares - sum * sum / static_cast<double>(channel->values.size());
  }
};

Names names_of(const Verdict& verdict) {
  Names names;
  for (const auto& cause : verdict.conclusion.causes) names.push_back(cause.name);
  return names;
}

double value_of(const Verdict& verdict, const std::string& name) {
  for (const auto& cause : verdict.conclusion.causes)
    for (const auto& parameter : cause.parameters)
      if (parameter.name == name) return parameter.value;
  for (const auto& parameter : verdict.evaluation.refitted)
    if (parameter.name == name) return parameter.after;
  ADD_FAILURE() << "the verdict has no " << name;
  return 0;
}

const Names kFriction{"coulomb_friction",
                      "asymmetric_friction",
                      "stribeck_friction",
                      "position_dependent_friction",
                      "bouc_wen",
                      "asymmetric_hysteresis",
                      "velocity_dependent_friction",
                      "power_damping"};

// Janot, Gautier & Brunot 2019, identified by least squares of the inverse model (IDIM-LS).
TEST_F(RealData, EmpsHasCoulombFrictionAndAnOffsetAsPublished) {
  open("emps");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed({"asymmetric_viscous", "asymmetric_friction"});

  EXPECT_NE(verdict.conclusion.outcome, Outcome::None);  // a remainder leaves names guesses
  EXPECT_EQ(names_of(verdict), (Names{"coulomb_friction", "force_offset"}));
  const std::pair<const char*, double> kPublished[] = {{"platen_inertia.mass", 95.1089},
                                                       {"viscous_friction.coefficient", 203.5034},
                                                       {"coulomb_friction.friction_force", 20.3935},
                                                       {"force_offset.offset", -3.1648}};
  for (const auto& [name, published] : kPublished)
    EXPECT_NEAR(value_of(verdict, name), published, 0.02 * std::abs(published)) << name;
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.046);
}

TEST_F(RealData, EmpsHasMoreFrictionBackwardsThanForwards) {
  open("emps");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed();

  EXPECT_NE(verdict.conclusion.outcome, Outcome::None);  // a remainder leaves names guesses
  EXPECT_EQ(names_of(verdict), (Names{"coulomb_friction", "asymmetric_viscous", "power_damping"}));
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.036);
  print_refit(verdict);
  // Without dry friction in the model, the fitted viscous friction is about twice its value.
  ASSERT_EQ(verdict.evaluation.refitted.size(), 2U);
  EXPECT_GT(verdict.evaluation.refitted[1].before, 1.9 * 203.5034);
}

TEST_F(RealData, EmpsWithoutFrictionInTheCatalogueIsUnknownAndDependsOnVelocity) {
  open("emps");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed(kFriction);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_EQ(verdict.descriptions[0].form, "f(v)");
}

TEST_F(RealData, SilverboxHasACubicSpring) {
  open("silverbox");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed();

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing);
  ASSERT_FALSE(verdict.conclusion.causes.empty());
  EXPECT_EQ(verdict.conclusion.causes[0].name, "cubic_stiffness");
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.0102);
  print_refit(verdict);
}

TEST_F(RealData, SilverboxWithoutItInTheCatalogueIsUnknownAndDependsOnDisplacement) {
  open("silverbox");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed({"cubic_stiffness", "polynomial_stiffness", "gap_contact",
                                     "piecewise_stiffness", "large_strain_stiffening"});

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_EQ(verdict.descriptions[0].form, "f(u) between mass 1 and the ground");
  EXPECT_GT(verdict.descriptions[0].share, 0.9);
}

// The example's recordings are part of the source tree.
class ActuatorExample : public RealData {
 protected:
  ActuatorExample() {
    recording_ = "actuator_example";
    case_ = load_case(test::source_tree() / "examples/diagnosis/actuator");
  }
};

TEST_F(ActuatorExample, LagsAndIsNotOnlyDelayed) {
  const Verdict verdict = diagnosed();

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing);
  ASSERT_FALSE(verdict.conclusion.causes.empty());
  EXPECT_NE(verdict.conclusion.causes[0].name, "actuator_delay");
  EXPECT_TRUE(verdict.conclusion.causes[0].name.find("lag") != std::string::npos ||
              verdict.conclusion.causes[0].name == "actuator_bandwidth")
      << verdict.conclusion.causes[0].name;
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.054);
  print_refit(verdict);
}

TEST_F(ActuatorExample, WithoutLagsInTheCatalogueIsUnknownAndDependsOnVelocity) {
  // A velocity limit and a gain explain a part of a lag.
  const Verdict verdict =
      diagnosed({"actuator_delay", "first_order_lag", "actuator_bandwidth", "oil_column_resonance",
                 "valve_deadband", "rate_saturation", "gain"});

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_NE(verdict.descriptions[0].form.find('v'), std::string::npos)
      << verdict.descriptions[0].form;
}

TEST_F(RealData, MrDamperHasFrictionThatDependsOnItsCurrent) {
  open("mr_damper");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed();

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing);
  ASSERT_FALSE(verdict.conclusion.causes.empty());
  EXPECT_EQ(verdict.conclusion.causes[0].name, "current_dependent_friction");
  EXPECT_GT(value_of(verdict, "current_dependent_friction.force_per_current"), 800);
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.156);
  print_refit(verdict);
}

TEST_F(RealData, MrDamperWithoutItInTheCatalogueIsUnknownAndDependsOnVelocityAndCurrent) {
  open("mr_damper");
  if (IsSkipped()) return;

  Names without = kFriction;
  without.emplace_back("current_dependent_friction");
  const Verdict verdict = diagnosed(without);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_EQ(verdict.descriptions[0].form, "sgn(v) g(I)");
}

TEST_F(RealData, FrictionDeviceHasFrictionBehindPlay) {
  open("brfd");
  if (IsSkipped()) return;

  const Verdict verdict = diagnosed();

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing);
  ASSERT_FALSE(verdict.conclusion.causes.empty());
  EXPECT_EQ(verdict.conclusion.causes[0].name, "asymmetric_hysteresis");
  const double play = value_of(verdict, "asymmetric_hysteresis.play");
  EXPECT_GT(play, 2e-3);
  EXPECT_LT(play, 7e-3);
  EXPECT_LE(held_out(verdict, &RecordScore::nrmse_after), 0.185);
  print_refit(verdict);
}

TEST_F(RealData, FrictionDeviceWithoutFrictionInTheCatalogueIsUnknownWithoutAForm) {
  open("brfd");
  if (IsSkipped()) return;

  Names without = kFriction;
  // A stiff spring that saturates imitates friction.
  without.insert(without.end(), {"mount_slack", "transducer_backlash", "force_saturation"});
  const Verdict verdict = diagnosed(without);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_LT(verdict.descriptions[0].share, 0.5);
}

// Cases of strangers.
class Stranger : public testing::TestWithParam<const char*> {};

TEST_P(Stranger, GetsAVerdictThatIsReadInAMinute) {
  const fs::path folder = test::source_tree() / "../shared/data/diagnosis_cases" / GetParam();
  if (!fs::exists(folder)) GTEST_SKIP() << "SKIPPED: there is no " << folder;

  const Verdict verdict = diagnose(load_case(folder), {});

  const Answers answers = answers_of(verdict);
  std::printf("  %s\n  %.1f s\n", answers.headline.c_str(), verdict.seconds);
  EXPECT_EQ(test::unreadable(answers.headline, {answers.missing, answers.certainty, answers.next}),
            "");
}

INSTANTIATE_TEST_SUITE_P(Corpus, Stranger,
                         testing::Values("plate_damper", "rocking_wall", "synthetic_coarse_rows",
                                         "synthetic_coarser_rows"));
INSTANTIATE_TEST_SUITE_P(LongCorpus, Stranger,
                         testing::Values("coupon_plastic", "seal_halves", "stone_wall",
                                         "student_damper/friction_fitted"));

}  // namespace
}  // namespace rths::diagnosis

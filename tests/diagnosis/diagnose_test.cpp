// SPDX-License-Identifier: Apache-2.0
#include <rths/verdict/diagnose.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/models/relations.hpp>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

// A guide with a spring and a damper on one axis. Formulas of this file, independent of the
// library, add hidden effects to its force.
struct Hidden {
  double friction = 0;      // [N]
  double ripple = 0;        // amplitude of an external force at 7.3 Hz [N]
  double force_step = 0;    // resolution of the load cell [N]
  double saturation = 1e9;  // range of the load cell [N]
  double stop = 0;          // stiffness of stops at ±60 mm [N/m]
  double shaped = 0;        // damping that changes with the displacement as a cosine [N·s/m]
};

constexpr double kStiffness = 2e5, kDamping = 3e3;  // [N/m], [N·s/m]

Record record_of(const std::string& name, Use use, unsigned seed, const Hidden& hidden) {
  double side = 0, before = 0;
  const auto guide = [&](double t, double x, double v) {
    // Coulomb friction with 0.1 mm of presliding: Dahl's law, solved exactly for each step.
    const double way = x - before, direction = way > 0 ? 1 : -1;
    side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
    before = x;
    double force = kStiffness * x + kDamping * v + hidden.friction * side;
    force += hidden.shaped * v * std::cos(x / 0.03);
    force += hidden.stop * (x - std::clamp(x, -0.06, 0.06));
    force +=
        hidden.ripple * (t < test_support::kQuiet ? 0 : std::sin(2 * std::numbers::pi * 7.3 * t));
    return std::clamp(force, -hidden.saturation, hidden.saturation);
  };
  return test_support::record_of(
      name, use, seed, guide,
      {.force_step = hidden.force_step, .length = test_support::kShortLength});
}

Case case_of(const Hidden& hidden) {
  Case c;
  c.name = "guide";
  c.records = {record_of("fit", Use::Fit, 1, hidden), record_of("second", Use::HeldOut, 2, hidden),
               record_of("unseen", Use::HeldOut, 3, hidden)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = 210_000\n"
      "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 2_500\n"
      "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
      "model");
  for (const char* name :
       {"polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"})
    c.model.fitted.push_back({name, std::nullopt});
  return c;
}

TEST(Diagnosis, FindsNothingMissingInACompleteModel) {
  const Verdict verdict = diagnose(case_of({}));

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::None) << verdict.sentence;
  EXPECT_TRUE(verdict.conclusion.causes.empty());
  ASSERT_EQ(verdict.evaluation.fit.size(), 3U);
  // Two seconds at rest in each record give the low third octaves to about 30 %.
  EXPECT_NEAR(verdict.evaluation.fit[2].variance_after, 1, 0.3);
}

// White noise of deviation σ sampled every Δt has a velocity of 2π σ √(2 Δt f³/3) below f. The
// motion ends near 1.5 Hz, the comparison at 25 Hz: without a filter of the motion, all of it would
// drive the model.
TEST(Diagnosis, DrivesItsModelByWhatIsNotNoiseInTheMotion) {
  constexpr double kNoise = 1e-4;  // [m]
  const Case clean = case_of({});
  Case noisy = clean;
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  for (Record& record : noisy.records)
    for (double& x : record.channels[0].values) x += kNoise * normal(random);

  const auto driven = [](const Case& c) {
    return force_relation(c, {})->prepare(c.records[0])->velocity.col(0).eval();
  };
  const Eigen::VectorXd error = driven(noisy) - driven(clean);

  const double unfiltered =
      2 * std::numbers::pi * kNoise * std::sqrt(2 * test_support::kStep * std::pow(25, 3) / 3);
  EXPECT_LT(std::sqrt(error.cwiseAbs2().mean()), unfiltered * std::pow(18.6 / 25, 1.5));
}

bool has_limit(const Verdict& verdict, const std::string& text) {
  return std::any_of(verdict.limits.begin(), verdict.limits.end(),
                     [&](const auto& limit) { return limit.find(text) != std::string::npos; });
}

// A linear specimen and its accelerometer. Sines at 7.3 Hz disturb the force and at 4.1 Hz the
// acceleration, in motion.
Record record_with_accelerometer(Use use, unsigned seed, double of_force, double of_acceleration) {
  std::vector<double> velocity, shaking;
  Record record = test_support::record_of(
      "record " + std::to_string(seed), use, seed,
      [&](double t, double x, double v) {
        const double moves = t < test_support::kQuiet ? 0 : 1;
        velocity.push_back(v);
        shaking.push_back(moves * of_acceleration * std::sin(2 * std::numbers::pi * 4.1 * t));
        return kStiffness * x + kDamping * v +
               moves * of_force * std::sin(2 * std::numbers::pi * 7.3 * t);
      },
      {.length = test_support::kShortLength});
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0, 0.01};
  Channel acceleration{"acceleration.long", "m/s2", std::vector<double>(velocity.size())};
  for (std::size_t k = 1; k + 1 < velocity.size(); ++k)
    acceleration.values[k] = (velocity[k + 1] - velocity[k - 1]) / (2 * test_support::kStep) +
                             noise(random) + shaking[k];
  record.channels.push_back(acceleration);
  return record;
}

// A linear specimen and its accelerometer, in records that are cut out of a motion. A filter does
// not know what was before them.
TEST(Diagnosis, FindsNothingMissingInRecordsThatBeginInMotion) {
  constexpr std::size_t kCut = 1000;  // 4 s
  Case c = case_of({});
  c.records.clear();
  for (const auto& [use, seed] :
       {std::pair{Use::Fit, 1U}, {Use::HeldOut, 2U}, {Use::HeldOut, 3U}}) {
    Record record = record_with_accelerometer(use, seed, 0, 0);
    for (auto& channel : record.channels)
      channel.values.erase(channel.values.begin(), channel.values.begin() + kCut);
    record.quiet.reset();
    c.records.push_back(record);
  }
  const Verdict verdict = diagnose(c);
  std::printf("  %s\n", verdict.sentence.c_str());

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::None) << verdict.sentence;
}

TEST(Diagnosis, NamesARestThatIsSampledFasterThanTheMotion) {
  Case c = case_of({});
  const std::string limit = "still is at rest at 1000 Hz, and fit moves at 250 Hz";

  EXPECT_FALSE(has_limit(diagnose(c), "is at rest at"));

  Record still = c.records[0];
  still.name = "still";
  still.use = Use::Reference;
  still.time_step /= 4;
  for (auto& channel : still.channels) channel.values.resize(still.quiet->second);
  c.records.push_back(still);
  EXPECT_TRUE(has_limit(diagnose(c), limit));
}

// Two relations have a residual without a name. The first of them is shown.
TEST(Diagnosis, QuotesTheFormOfTheResidualThatItShows) {
  Case c = case_of({});
  c.records.clear();
  for (const auto& [use, seed] : {std::pair{Use::Fit, 1U}, {Use::HeldOut, 2U}, {Use::HeldOut, 3U}})
    c.records.push_back(record_with_accelerometer(use, seed, 400, 0.2));

  const Verdict verdict = diagnose(c);

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.where.channel, "acceleration.long");
  EXPECT_NE(verdict.sentence.find("external periodic force at 4.1"), std::string::npos)
      << verdict.sentence;
  EXPECT_TRUE(std::any_of(verdict.descriptions.begin(), verdict.descriptions.end(),
                          [](const Description& one) {
                            return one.form.starts_with("external periodic force at 7.3");
                          }));
}

// The held-out records visit larger states than the first. The comparison's filter passes the
// motion, which ends near 1.1 Hz, but for a thousandth.
TEST(Diagnosis, LimitsItselfToTheStatesOfAllRecords) {
  Case c = case_of({});
  for (auto& channel : c.records[2].channels)
    for (double& value : channel.values) value *= 1.5;
  double most = 0;
  for (const auto& record : c.records)
    for (const double u : record.channels[0].values) most = std::max(most, std::abs(u));

  const Verdict verdict = diagnose(c);

  const std::string begin = "motion to force: states beyond ";
  const auto limit = std::find_if(verdict.limits.begin(), verdict.limits.end(),
                                  [&](const auto& one) { return one.starts_with(begin); });
  ASSERT_NE(limit, verdict.limits.end());
  EXPECT_NEAR(std::stod(limit->substr(begin.size())) / most, 1, 1e-2);
}

TEST(Diagnosis, NamesTheFilterOfItsErrorsAndChannelsThatItIgnores) {
  Case c = case_of({});
  for (auto& record : c.records)
    for (const char* role : {"command.long", "displacement.vertical"})
      record.channels.push_back({role, "m", std::vector<double>(record.samples())});

  const Verdict verdict = diagnose(c);

  EXPECT_TRUE(has_limit(
      verdict, "Not used by a model of kind 'platen': command.long, displacement.vertical."));
  EXPECT_TRUE(has_limit(verdict, "motion to force: errors are those of signals below 25 Hz"));
  EXPECT_FALSE(has_limit(verdict, "Check its unit"));
  EXPECT_TRUE(verdict.noise.remedy.empty());
}

// The records move from second 2 on. Without quiet_s the diagnosis finds these seconds itself.
TEST(Diagnosis, SaysHowToMeasureTheNoise) {
  Case c = case_of({.ripple = 200});
  for (auto& record : c.records) record.quiet.reset();

  const Verdict verdict = diagnose(c);

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
  const auto at = verdict.sentence.find("quiet_s = [0, ");
  ASSERT_NE(at, std::string::npos) << verdict.sentence;
  const double end = std::stod(verdict.sentence.substr(at + 14));
  EXPECT_GE(end, test_support::kQuiet - 0.01);
  EXPECT_LT(end, test_support::kQuiet + 0.2);
}

TEST(Diagnosis, DoubtsADisplacementThatNoMachineReaches) {
  Case c = case_of({});
  for (auto& record : c.records)
    for (auto& value : record.channels[0].values) value *= 1000;

  EXPECT_TRUE(has_limit(diagnose(c), "displacement.long reaches"));
}

TEST(Diagnosis, NamesFrictionAndProvesItOnTheUnseenRecord) {
  const Verdict verdict = diagnose(case_of({.friction = 300}));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, "coulomb_friction");
  EXPECT_EQ(verdict.conclusion.where.part, Part::Machine);
  EXPECT_DOUBLE_EQ(verdict.conclusion.causes[0].explained, verdict.evaluation.proof.explained);
  const Estimate& force = verdict.conclusion.causes[0].parameters[0];
  EXPECT_NEAR(force.value, 300, 10);
  EXPECT_LT(force.low, 300);
  EXPECT_GT(force.high, 300);
  EXPECT_EQ(verdict.evaluation.proof_record, "unseen");
  const RecordScore& proof = verdict.evaluation.fit.back();
  EXPECT_LT(proof.nrmse_after, 0.3 * proof.nrmse_before);
  EXPECT_LT(proof.nrmse_after, 1.2 * proof.noise_floor);
  EXPECT_NE(verdict.improvement.fragment.find("friction_force_N = "), std::string::npos);
}

TEST(Diagnosis, DescribesAnUnknownEffect) {
  const Verdict verdict = diagnose(case_of({.ripple = 200}));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
  ASSERT_FALSE(verdict.descriptions.empty());
  EXPECT_EQ(verdict.descriptions[0].form.rfind("external periodic force at 7.3", 0), 0U)
      << verdict.descriptions[0].form;
  for (const char* part : {"none of the terms that were searched explains it",
                           "on a record that it was not fitted to"})
    EXPECT_NE(verdict.sentence.find(part), std::string::npos) << verdict.sentence;
  // An external force is visible without motion.
  EXPECT_EQ(verdict.next.text.rfind("no motion", 0), 0U) << verdict.next.text;
  ASSERT_EQ(verdict.next.motion.channels.size(), 1U);
  const auto& still = verdict.next.motion.channels[0].second;
  EXPECT_TRUE(std::all_of(still.begin(), still.end(), [](double u) { return u == 0; }));
}

// With one held-out record, halves of the fitted one score each other.
TEST(Diagnosis, SaysThatAFormExplainsPiecesOfItsOwnRecord) {
  Case c = case_of({.ripple = 200});
  c.records.erase(c.records.begin() + 1);

  const Verdict verdict = diagnose(c);

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Unknown) << verdict.sentence;
  EXPECT_NE(verdict.sentence.find("on pieces of the records that it was not fitted to"),
            std::string::npos)
      << verdict.sentence;
}

TEST(Diagnosis, SaysUnknownWhenTheTermIsExcluded) {
  const Verdict verdict =
      diagnose(case_of({.friction = 300}),
               {.without = {"coulomb_friction", "asymmetric_friction", "stribeck_friction",
                            "position_dependent_friction", "bouc_wen", "asymmetric_hysteresis",
                            "velocity_dependent_friction", "power_damping"}});

  EXPECT_TRUE(verdict.conclusion.outcome == Outcome::Unknown || verdict.conclusion.has_remainder)
      << verdict.sentence;
  // Friction is a function of velocity, f(v), or one whose size may depend on displacement.
  EXPECT_NE(verdict.next.text.find("velocity most evenly"), std::string::npos) << verdict.next.text;
}

TEST(Diagnosis, FindsCoarseQuantisationInTheSamples) {
  const Verdict verdict = diagnose(case_of({.force_step = 400}));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, "force_quantisation");
  EXPECT_NEAR(verdict.conclusion.causes[0].parameters[0].value, 400, 1e-6);
  EXPECT_TRUE(
      std::isnan(verdict.conclusion.causes[0].explained));  // steps are found in the samples
  EXPECT_EQ(verdict.conclusion.where.part, Part::Sensor);
}

TEST(Diagnosis, BlamesTheLoadCellForItsRange) {
  const Verdict verdict = diagnose(case_of({.saturation = 14'000}));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, "force_saturation");
  EXPECT_EQ(verdict.conclusion.where.part, Part::Sensor);
  const Estimate& limit = verdict.conclusion.causes[0].parameters[0];
  EXPECT_NEAR(limit.value, 14'000, 50);
  EXPECT_LT(limit.high - limit.low, 200);
}

// On one axis, a stop behind a gap and stiffening beyond an onset are the same law: either is
// named, and the other is its alternative.
TEST(Diagnosis, NamesAStopBehindAGap) {
  const Verdict verdict = diagnose(case_of({.stop = 3e5}));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
  const Cause& cause = verdict.conclusion.causes[0];
  ASSERT_FALSE(cause.alternatives.empty()) << verdict.sentence;
  EXPECT_EQ(cause.name, "gap_contact");
  EXPECT_EQ(cause.alternatives[0].name, "large_strain_stiffening");
  EXPECT_NEAR(cause.alternatives[0].share, 1, 1e-3);
  EXPECT_GE(cause.confidence, 1 / (1 + static_cast<double>(cause.alternatives.size())));
  for (const auto& parameter : cause.parameters) {
    const bool is_gap = parameter.name == "gap_contact.gap";
    EXPECT_NEAR(parameter.value, is_gap ? 0.06 : 3e5, is_gap ? 6e-4 : 6e3) << parameter.name;
  }
}

TEST(Diagnosis, RejectsUnknownTerms) {
  try {
    static_cast<void>(
        diagnose(case_of({}), {.without = {"gain", "force_gain", "columb_friction"}}));
    FAIL() << "an unknown name was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "without: there is no term 'columb_friction' (did you mean 'coulomb_friction'?)");
  }
}

TEST(Diagnosis, MapsAllVisitedStates) {
  const Verdict verdict = diagnose(case_of({.friction = 300}));

  const Where& where = verdict.conclusion.where;
  ASSERT_GT(where.state_map.size(), where.states.size());
  double all = 0, smallest_set = 0;
  for (const auto& cell : where.state_map) all += std::max(0.0, cell.share);
  for (const auto& cell : where.states) smallest_set += cell.share;
  EXPECT_GE(smallest_set, 0.8);
  EXPECT_GE(all, smallest_set);
  // White noise of about 950 rows.
  EXPECT_NEAR(verdict.evaluation.residual.bound, 1.96 / std::sqrt(950), 2e-3);
}

TEST(Diagnosis, MapsTheExcessOverAccelerationAndDissipatedEnergy) {
  const Verdict verdict = diagnose(case_of({.friction = 300}));

  const auto profile = [&](const std::string& name) {
    const auto& all = verdict.conclusion.where.profiles;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Profile& one) { return one.name == name; });
    return found == all.end() ? Profile{} : *found;
  };
  const Profile acceleration = profile("acceleration.long"), energy = profile("dissipated energy");
  ASSERT_FALSE(acceleration.share.empty());
  ASSERT_EQ(energy.unit, "J");
  // Damper and friction dissipate the integral of c v² + F |v| over the record's motion. The work
  // of force on displacement gives the same, since a spring returns its work.
  const Record record = record_of("fit", Use::Fit, 1, {.friction = 300});
  const auto &u = record.channels[0].values, &f = record.channels[1].values;
  double work = 0;
  for (std::size_t k = 1; k < u.size(); ++k) work += (f[k] + f[k - 1]) / 2 * (u[k] - u[k - 1]);
  EXPECT_NEAR(energy.edges.front(), 0, 1e-3 * work);
  // The difference: energy stored in the spring, and the last second, which filters distort.
  EXPECT_NEAR(energy.edges.back(), work, 0.1 * work);
}

TEST(Diagnosis, GivesTheSameVerdictForTheSameSeed) {
  const Case c = case_of({.friction = 300});

  const Verdict one = diagnose(c), other = diagnose(c);

  EXPECT_EQ(one.sentence, other.sentence);
  EXPECT_EQ(one.conclusion.causes[0].parameters[0].value,
            other.conclusion.causes[0].parameters[0].value);
}

}  // namespace
}  // namespace rths::diagnosis

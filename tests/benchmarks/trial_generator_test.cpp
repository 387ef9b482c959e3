// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "actuator.hpp"
#include "answer.hpp"
#include "case_folder.hpp"
#include "motion.hpp"
#include "support/files.hpp"
#include "truth.hpp"

namespace {

using namespace trial;
namespace fs = std::filesystem;

// Sines of many periods that grow and fade, as an earthquake for tests.
double shaking(double time, double shift) {
  double sum = 0;
  for (int k = 0; k < 12; ++k)
    sum += std::sin(2 * std::numbers::pi * (0.31 + 0.23 * k + 0.01 * k * k) * time + k * shift) /
           (1 + 0.2 * k);
  return 0.1 * time * std::exp(-time / 4) * sum;
}

std::vector<GroundMotion> made_up_motions() {
  std::vector<GroundMotion> motions;
  for (int number = 0; number < 3; ++number) {
    GroundMotion motion{.name = "made_up_" + std::to_string(number), .step = 0.01};
    for (int k = 0; k < 3600; ++k) {
      motion.first.push_back(shaking(0.01 * k, 1 + number));
      motion.second.push_back(shaking(0.01 * k, 2.6 + number));
      motion.vertical.push_back(0.5 * shaking(0.015 * k, 4.1 + number));
    }
    motion.has_vertical = true;
    motions.push_back(motion);
  }
  return motions;
}

// The first case of a seed with this hidden effect; nullptr: without an effect.
CaseId case_with(const Effect* wanted) {
  CaseId id{.seed = 3};
  const auto is_it = [&] {
    const std::vector<const Effect*> hidden = plan(id);
    return wanted == nullptr ? hidden.empty() : hidden.size() == 1 && hidden[0] == wanted;
  };
  while (!is_it()) ++id.number;
  return id;
}

TrialCase trial_with(std::string_view name) {
  return make_case(case_with(name == "none" ? nullptr : &effect(name)), made_up_motions());
}

// A motion of one axis, so slow that friction is the only resistance.
Motion sine(double amplitude, double frequency_Hz, double seconds) {
  Motion motion;
  const double omega = 2 * std::numbers::pi * frequency_Hz;
  for (double t = 0; t < seconds; t += kModelStep) {
    Boundary now{.time = t};
    now.displacement[0] = amplitude * std::sin(omega * t);
    now.velocity[0] = amplitude * omega * std::cos(omega * t);
    now.acceleration[0] = -amplitude * omega * omega * std::sin(omega * t);
    motion.push_back(now);
  }
  return motion;
}

TEST(TrialGenerator, SameCaseHasTheSameBytes) {
  const rths::test::TemporaryFolder folder;
  const CaseId id = case_with(&effect("coulomb_friction"));

  for (const char* copy : {"one", "other"})
    write_case_folder(make_case(id, made_up_motions()), folder.path() / copy);

  for (const char* file : {"case.toml", "fit.csv", "second.csv", "unseen.csv"}) {
    EXPECT_EQ(rths::test::content_of(folder.path() / "one" / file),
              rths::test::content_of(folder.path() / "other" / file));
    EXPECT_FALSE(rths::test::content_of(folder.path() / "one" / file).empty());
  }
}

TEST(TrialGenerator, CaseFolderDoesNotContainTheAnswer) {
  const rths::test::TemporaryFolder folder;
  const TrialCase trial = trial_with("p_delta");

  write_case_folder(trial, folder.path() / "case");

  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator{folder.path() / "case"}) {
    const std::string bytes = rths::test::content_of(entry.path());
    for (const Effect& candidate : effects())
      EXPECT_EQ(bytes.find("\"" + std::string(candidate.name)), std::string::npos);
    EXPECT_EQ(bytes.find("p_delta"), std::string::npos);
    ++files;
  }
  EXPECT_EQ(files, 4U);  // case.toml and three recordings
  EXPECT_NE(answer(trial, TruthDepth::None).find("p_delta"), std::string::npos);
}

TEST(TrialGenerator, CaseRequestsTheMapOfTheAnswer) {
  const rths::test::TemporaryFolder folder;

  write_case_folder(trial_with("none"), folder.path());

  const std::string toml = rths::test::content_of(folder.path() / "case.toml");
  const std::size_t map = toml.find("\n[map]\n");
  ASSERT_NE(map, std::string::npos);
  const auto number_of = [&](const std::string& key) {
    return std::stod(toml.substr(toml.find(key + " = ", map) + key.size() + 3));
  };
  EXPECT_EQ(number_of("displacement_m"), kStateDisplacement);
  EXPECT_EQ(number_of("velocity_m_per_s"), kStateVelocity);
}

TEST(TrialGenerator, EveryEffectOccursOnceInABlock) {
  std::vector<std::string_view> seen;
  for (std::uint64_t k = 0; k < block_of(Tier::Standard).size(); ++k)
    for (const Effect* hidden : plan({.seed = 5, .number = k})) seen.push_back(hidden->name);

  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
  EXPECT_EQ(seen.size(), effects().size());
}

TEST(TrialGenerator, AbsentEffectChangesNothing) {
  const TrialCase trial = trial_with("none");

  for (const Effect& candidate : effects()) {
    if (candidate.relation != Relation::Force) continue;
    Physics physics = trial.physics;
    Random random{1, 1};
    add(candidate, 0, random, physics);
    const Motion motion = sine(0.1, 0.5, 3);
    const auto with = force_at(physics, motion), without = force_at(trial.physics, motion);
    EXPECT_EQ(with, without) << candidate.name;
  }
  EXPECT_EQ(truth_of(trial, effect("p_delta"), false).energy, 0);
}

TEST(TrialGenerator, LoopIsStableAndAtRestUntilTheGroundMoves) {
  for (const char* name : {"none", "force_time_skew", "oil_column_resonance", "load_compliance",
                           "actuator_delay", "platen_inertia"}) {
    const TrialCase trial = trial_with(name);
    for (const Record& record : trial.records) {
      EXPECT_GT(record.peak_displacement(), 0.08) << name;
      EXPECT_LT(record.peak_displacement(), 0.3) << name;
      const auto at = [&](double t) { return static_cast<std::size_t>(t / kSampleTime); };
      for (std::size_t k = 0; k < at(1.9); ++k)
        ASSERT_EQ(record.truth[k].displacement, Plane{}) << name;
      // The ground motion has faded to a hundredth: the remaining motion is free vibration.
      for (std::size_t k = at(39); k < at(40); ++k)
        ASSERT_LT(std::abs(record.truth[k].velocity[0]), 0.05) << name;
    }
  }
}

TEST(TrialGenerator, EnergyOfALinearEffectGrowsWithTheSquareOfItsSize) {
  TrialCase trial = trial_with("viscous_friction");
  const double once = truth_of(trial, *trial.hidden[0], false).energy;

  TrialCase doubled = trial;
  doubled.physics[kViscousX] *= 2;
  doubled.physics[kViscousY] *= 2;
  const double twice = truth_of(doubled, *trial.hidden[0], false).energy;

  // The whitening noise contains the larger effect too, so the ratio is not exactly 4.
  EXPECT_NEAR(twice / once, 4, 0.1);
}

TEST(TrialGenerator, NuisancesTakeEnergyFromAnEffectButAddNone) {
  const TrialCase trial = trial_with("viscous_friction");

  const EffectTruth truth = truth_of(trial, *trial.hidden[0], false);

  EXPECT_GT(truth.information, 0);
  EXPECT_LT(truth.information, truth.energy);
}

TEST(TrialGenerator, BearingObeysItsClosedForm) {
  Physics physics = absent();
  Bearing bearing{physics, 1e-3};
  const double yield = physics[kYieldDisplacement];
  constexpr double kRate = 0.01;  // [m/s]
  for (int k = 1; k <= 5000; ++k) {
    Boundary now{.time = 1e-3 * k};
    now.displacement[0] = kRate * now.time;

    const Plane force = bearing.advance(now);

    // For n = 2 and one axis dz = (1 - z²) du / u_y from rest, so z = tanh(u / u_y); Heun's error
    // is below (du / u_y)² = 4e-7.
    const double u = now.displacement[0];
    const double exact = physics[kStiffness] * u + physics[kStrength] * std::tanh(u / yield);
    ASSERT_NEAR(force[0], exact, 1e-6 * physics[kStrength]);
    ASSERT_EQ(force[1], 0);
  }
}

TEST(TrialGenerator, FrictionDissipatesFourTimesForceAndAmplitudeInACycle) {
  Physics physics = absent();
  physics[kStiffness] = physics[kStrength] = 0;
  physics[kFrictionX] = 10e3;
  constexpr double kAmplitude = 0.1, kPeriod = 4;
  Motion motion = sine(kAmplitude, 1 / kPeriod, 2 * kPeriod);
  for (Boundary& now : motion) now.acceleration = {};

  const std::vector<Plane> force = force_at(physics, motion);

  double work = 0;
  for (std::size_t k = motion.size() / 2; k < motion.size(); ++k)
    work += 0.5 * (force[k][0] + force[k - 1][0]) *
            (motion[k].displacement[0] - motion[k - 1].displacement[0]);
  // After each reversal the force changes sign over z_s, a loss of 2 F z_s twice a cycle.
  const double exact = 4 * 10e3 * (kAmplitude - physics[kPresliding]);
  EXPECT_NEAR(work, exact, 0.002 * exact);
}

TEST(TrialGenerator, ActuatorHasItsDelayAndLag) {
  Actuator actuator{absent(), kSampleTime};
  constexpr double kSpeed = 0.1;  // [m/s]
  double sent = 0;
  for (int k = 1; k <= 2000; ++k) {
    sent = kSpeed * k * kSampleTime;
    actuator.advance({sent, 0}, {});
  }

  // On a ramp, a second-order servo lags by 2 ζ / ω. The last millisecond of the transport delay is
  // the ramp to the sent command, which this command already follows.
  const double lag = 2 * kActuatorDamping / (2 * std::numbers::pi * kActuatorFrequency);
  const double late = kTransportDelay - kSampleTime + lag;
  EXPECT_NEAR(actuator.platen().displacement[0], sent - kSpeed * late, 1e-9);
}

TEST(TrialGenerator, DriftAffectsTheForceAlone) {
  const TrialCase drifting = trial_with("loadcell_drift");
  Physics still = drifting.physics_of(0);
  remove(*drifting.hidden[0], still);
  const Motion motion = true_motion(drifting.records[0]);

  const auto with = force_at(drifting.physics_of(0), motion), without = force_at(still, motion);

  const double share = motion.back().time / kRecordLength;
  EXPECT_NEAR(with.back()[0] - without.back()[0], share * drifting.physics[kDriftX], 1e-3);
  EXPECT_NEAR(with.back()[1] - without.back()[1], share * drifting.physics[kDriftY], 1e-3);
  EXPECT_GT(std::abs(drifting.physics[kDriftX]), 8e3);
}

TEST(TrialGenerator, NoiseHasItsStatedDeviationAndColour) {
  const NoiseColour colour{.deviation = 2};
  Random random{4, 4};
  Noise noise{colour, kSampleTime, random};
  constexpr int kMany = 400000;
  double square = 0, product = 0, last = noise.next(random);
  for (int k = 0; k < kMany; ++k) {
    const double value = noise.next(random);
    square += value * value / kMany;
    product += value * last / kMany;
    last = value;
  }

  double neighbour = 0;  // correlation of adjacent samples
  for (std::size_t i = 0; i < 3; ++i)
    neighbour +=
        colour.share[i] * std::exp(-2 * std::numbers::pi * colour.corner_Hz[i] * kSampleTime);
  // The slowest component changes about 1000 times in these 400 s: 3 sigma of its variance are 2 %.
  EXPECT_NEAR(std::sqrt(square), 2, 0.04);
  EXPECT_NEAR(product / square, neighbour, 0.01);
}

}  // namespace

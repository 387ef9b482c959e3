// SPDX-License-Identifier: Apache-2.0
// Runs the test that a diagnosis proposes on a specimen; its result separates the tied terms. The
// specimens are formulas of this file, independent of the library.
#include <rths/verdict/diagnose.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace rths::diagnosis {
namespace {

constexpr double kStep = 0.004, kLength = 40, kQuiet = 2;  // [s]
constexpr double kTurn = 2 * std::numbers::pi;

using Motion = std::function<double(double t)>;
/// Noise-free measurement of a motion, by sample.
using Specimen = std::function<std::vector<double>(const Motion&, double length)>;

struct Channels {
  std::string motion, measured, unit;
  double motion_noise, noise;
};

// A sine of one frequency, as in many laboratory tests.
Motion sine(double amplitude, double frequency) {
  return [=](double t) {
    if (t < kQuiet) return 0.0;
    const double rise = 1 - std::exp(-std::pow((t - kQuiet) / 3, 2));
    return amplitude * rise * std::sin(kTurn * frequency * (t - kQuiet));
  };
}

Record recorded(const std::string& name, Use use, const Specimen& specimen, const Motion& motion,
                double length, const Channels& channels, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = kStep;
  Channel moved{channels.motion, "m", {}};
  Channel measured{channels.measured, channels.unit, specimen(motion, length)};
  for (std::size_t k = 0; k < measured.values.size(); ++k) {
    moved.values.push_back(motion(static_cast<double>(k) * kStep) +
                           channels.motion_noise * normal(random));
    measured.values[k] += channels.noise * normal(random);
  }
  record.channels = {moved, measured};
  record.quiet = {0, static_cast<std::size_t>(kQuiet / kStep)};
  return record;
}

// The motion that a verdict proposes, interpolated between its samples.
Motion proposed(const Verdict& verdict) {
  const auto values = verdict.next.motion.channels.at(0).second;
  const double step = verdict.next.motion.time_step;
  return [=](double t) {
    const double position =
        std::clamp(t / step, 0.0, static_cast<double>(values.size() - 1) - 1e-9);
    const auto k = static_cast<std::size_t>(position);
    return values[k] + (position - static_cast<double>(k)) * (values[k + 1] - values[k]);
  };
}

double length_of(const Verdict& verdict) {
  return static_cast<double>(verdict.next.motion.channels.at(0).second.size()) *
         verdict.next.motion.time_step;
}

bool is_tied(const Verdict& verdict, const std::string& name) {
  if (verdict.conclusion.causes.empty()) return false;
  const auto& others = verdict.conclusion.causes[0].alternatives;
  return verdict.conclusion.causes[0].name == name ||
         std::any_of(others.begin(), others.end(),
                     [&](const Alternative& other) { return other.name == name; });
}

// A spring, and in parallel a spring and a dashpot in series (Maxwell): f' = k u' − f/τ.
Specimen rubber(double relaxation_time) {
  return [=](const Motion& motion, double length) {
    constexpr double kStiffness = 2e5, kBranch = 2e4;  // [N/m]
    constexpr int kSubsteps = 20;
    constexpr double dt = kStep / kSubsteps;
    std::vector<double> force;
    double branch = 0, before = motion(0);
    for (double t = 0; force.size() < static_cast<std::size_t>(length / kStep); t += kStep) {
      for (int i = 0; i < kSubsteps && t > 0; ++i) {
        const double u = motion(t - kStep + (i + 1) * dt);
        const double decay = std::exp(-dt / relaxation_time);
        // Exact for a motion at constant velocity.
        branch = branch * decay + kBranch * relaxation_time * (1 - decay) * (u - before) / dt;
        before = u;
      }
      force.push_back(kStiffness * motion(t) + branch);
    }
    return force;
  };
}

Case rubber_case(double relaxation_time) {
  const Channels channels{"displacement.long", "force.long", "N", 2e-7, 20};
  const Specimen specimen = rubber(relaxation_time);
  Case c;
  c.name = "rubber";
  c.records = {recorded("fit", Use::Fit, specimen, sine(0.03, 0.5), kLength, channels, 1),
               recorded("second", Use::HeldOut, specimen, sine(0.025, 0.5), kLength, channels, 2),
               recorded("unseen", Use::HeldOut, specimen, sine(0.02, 0.5), kLength, channels, 3)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = 210_000\n", "model");
  c.model.fitted = {{"polynomial_stiffness.linear", std::nullopt}};
  return c;
}

TEST(TestProposal, SeparatesRelaxationFromDampingWhichOneFrequencyCannot) {
  constexpr double kRelaxationTime = 0.2;
  Case c = rubber_case(kRelaxationTime);
  // At one amplitude it looks like damping too.
  DiagnosisOptions options;
  options.without = {"velocity_dependent_friction"};
  const Verdict tied = diagnose(c, options);
  ASSERT_EQ(tied.conclusion.outcome, Outcome::Missing) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "viscous_friction")) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "viscoelastic_relaxation")) << tied.sentence;
  ASSERT_FALSE(tied.next.text.empty()) << tied.sentence;

  c.records.push_back(recorded("next", Use::Fit, rubber(kRelaxationTime), proposed(tied),
                               length_of(tied), {"displacement.long", "force.long", "N", 2e-7, 20},
                               4));
  const Verdict decided = diagnose(c, options);

  ASSERT_EQ(decided.conclusion.causes.size(), 1U) << tied.sentence << "\n" << decided.sentence;
  EXPECT_EQ(decided.conclusion.causes[0].name, "viscoelastic_relaxation") << decided.sentence;
  EXPECT_TRUE(decided.conclusion.causes[0].alternatives.empty()) << decided.sentence;
}

// A spring, and friction of the guides in proportion to the load, with 0.01 mm of presliding.
Specimen guided(double load) {
  return [=](const Motion& motion, double length) {
    constexpr double kStiffness = 2e5, kCoefficient = 0.01, kPresliding = 1e-5;  // [N/m], [-], [m]
    std::vector<double> force;
    double bent = 0, before = motion(0);
    for (double t = 0; force.size() < static_cast<std::size_t>(length / kStep); t += kStep) {
      bent = std::clamp(bent + motion(t) - before, -kPresliding, kPresliding);
      before = motion(t);
      force.push_back(kStiffness * motion(t) + kCoefficient * load * bent / kPresliding);
    }
    return force;
  };
}

// Under a load that is constant, such friction is Coulomb's.
TEST(TestProposal, SeparatesFrictionThatDependsOnTheLoadByAnotherLoad) {
  constexpr double kLoad = 1e6;  // [N]
  Case c = rubber_case(0.2);
  const Channels channels{"displacement.long", "force.long", "N", 2e-7, 100};
  for (auto& record : c.records) {
    record = recorded(record.name, record.use, guided(kLoad), sine(0.03, 0.5), kLength, channels,
                      static_cast<unsigned>(record.name.size()));
    record.channels.push_back(
        {"vertical_force", "N", std::vector<double>(record.samples(), kLoad)});
  }

  const Verdict tied = diagnose(c);

  ASSERT_NE(tied.conclusion.outcome, Outcome::None) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "coulomb_friction")) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "load_dependent_friction")) << tied.sentence;
  EXPECT_NE(tied.next.text.find("load_dependent_friction"), std::string::npos) << tied.sentence;
  EXPECT_TRUE(tied.next.text.starts_with("empty table") ||
              tied.next.text.find("at vertical_force of") != std::string::npos)
      << tied.sentence;
}

// An actuator with a pure delay, or with a first-order lag, u' = (command − u)/τ.
enum class Lateness { Delay, Lag };

Specimen actuator(Lateness lateness, double time) {
  return [=](const Motion& motion, double length) {
    constexpr int kSubsteps = 20;
    constexpr double dt = kStep / kSubsteps;
    std::vector<double> displacement;
    double u = 0;
    for (double t = 0; displacement.size() < static_cast<std::size_t>(length / kStep); t += kStep) {
      // Exact for a command that is constant within a substep.
      for (int i = 0; i < kSubsteps && t > 0; ++i)
        u += (motion(t - kStep + (i + 0.5) * dt) - u) * (1 - std::exp(-dt / time));
      displacement.push_back(lateness == Lateness::Delay ? motion(std::max(0.0, t - time)) : u);
    }
    return displacement;
  };
}

struct Late {
  Lateness lateness;
  std::string name, rival;
};

class LateActuator : public testing::TestWithParam<Late> {};

TEST_P(LateActuator, IsIdentifiedByTheProposedTest) {
  constexpr double kTime = 0.03;  // [s]
  const auto [lateness, name, rival] = GetParam();
  const Channels channels{"command.long", "displacement.long", "m", 0, 3e-5};
  const Specimen specimen = actuator(lateness, kTime);
  Case c;
  c.name = "axis";
  c.records = {recorded("fit", Use::Fit, specimen, sine(0.03, 0.5), kLength, channels, 1),
               recorded("second", Use::HeldOut, specimen, sine(0.025, 0.5), kLength, channels, 2),
               recorded("unseen", Use::HeldOut, specimen, sine(0.02, 0.5), kLength, channels, 3)};
  c.model.kind = ModelKind::ServoAxis;
  const Verdict tied = diagnose(c);
  ASSERT_EQ(tied.conclusion.outcome, Outcome::Missing) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "actuator_delay")) << tied.sentence;
  ASSERT_TRUE(is_tied(tied, "first_order_lag")) << tied.sentence;
  ASSERT_FALSE(tied.next.text.empty()) << tied.sentence;

  c.records.push_back(
      recorded("next", Use::Fit, specimen, proposed(tied), length_of(tied), channels, 4));
  const Verdict decided = diagnose(c);

  ASSERT_EQ(decided.conclusion.causes.size(), 1U) << tied.sentence << "\n" << decided.sentence;
  EXPECT_EQ(decided.conclusion.causes[0].name, name) << decided.sentence;
  // A term that includes a lag as a special case, such as a second-order lag, stays possible.
  EXPECT_FALSE(is_tied(decided, rival)) << decided.sentence;
}

INSTANTIATE_TEST_SUITE_P(All, LateActuator,
                         testing::Values(Late{Lateness::Delay, "actuator_delay", "first_order_lag"},
                                         Late{Lateness::Lag, "first_order_lag", "actuator_delay"}),
                         [](const auto& late) { return late.param.name; });

}  // namespace
}  // namespace rths::diagnosis

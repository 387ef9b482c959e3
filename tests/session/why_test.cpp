// SPDX-License-Identifier: Apache-2.0
//
// Pairs of runs in virtual time, of which one has a hidden change, and why they differ.
#include <rths/session/why.hpp>

#include <cmath>
#include <cstdio>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/excerpt.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

using experiment::Overrides;

class PairOfRuns : public ::testing::Test {
 protected:
  static std::filesystem::path made(const std::string& name, const Overrides& changes) {
    const auto file = folder().path() / (name + ".h5");
    if (std::filesystem::exists(file)) return file;
    Overrides all{{"duration_s", "12"}, {"rest_s", "1"}};
    all.insert(all.end(), changes.begin(), changes.end());
    launch::RunOptions options;
    options.clock = launch::ClockKind::Virtual;
    options.recording = file;
    options.overrides = all;
    const auto experiment =
        app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml", all);
    EXPECT_TRUE(launch::run(experiment, options).completed);
    return file;
  }
  /// Why a run differs from the example.
  static Difference why_of(const std::string& name, const Overrides& changes) {
    return why(report::compare(made("example", {}), made(name, changes), {}));
  }
  static std::string first_cause(const Difference& difference) {
    if (!difference.verdict || difference.verdict->conclusion.causes.empty()) return "";
    return difference.verdict->conclusion.causes.front().name;
  }

 private:
  static const test::TemporaryFolder& folder() {
    static const test::TemporaryFolder folder;
    return folder;
  }
};

TEST_F(PairOfRuns, HasNoCauseIfOnlyTheNoiseDiffers) {
  const auto found = why_of("other_noise", {{"seed", "1993"}});

  EXPECT_EQ(first_cause(found), "");
  EXPECT_TRUE(found.mistakes.empty());
  EXPECT_EQ(found.sentence.find("Nothing is missing"), 0U) << found.sentence;
}

TEST_F(PairOfRuns, HasNoCauseIfNothingDiffers) {
  EXPECT_EQ(why_of("example", {}).sentence, "Nothing differs.");
}

TEST_F(PairOfRuns, HasTheGainOfALoadCell) {
  const auto found = why_of("gain", {{"machine.gain", "{kind = 'gain', factor = 1.04}"}});

  EXPECT_EQ(first_cause(found), "force_gain");
  EXPECT_FALSE(found.is_reversed);
}

TEST_F(PairOfRuns, HasTheDelayOfAnActuator) {
  const auto found = why_of("delay", {{"machine.actuator_delay.delay_s", "0.01"}});

  ASSERT_FALSE(found.mistakes.empty());
  EXPECT_EQ(found.mistakes[0].find("the machine follows its reference "), 0U);
  EXPECT_NE(found.mistakes[0].find(" ms later (long)"), std::string::npos) << found.mistakes[0];
}

TEST_F(PairOfRuns, HasAMistakeOfAUnit) {
  const auto run = made("example", {});
  const recording::Reader reader{run};
  auto table =
      recording::make_excerpt(reader, {"srmd.long.force.fbk", "srmd.lat.force.fbk"}, 0, 10);
  for (double& force : table.values[0]) force *= 1e-3;
  const test::TemporaryFolder folder;
  recording::write_csv(table, folder.path() / "table.csv");
  const auto found = why(report::compare(run, folder.path() / "table.csv", {}));

  EXPECT_EQ(found.sentence,
            "srmd.long.force.fbk is 0.001 times the baseline, as if kN had been read as N.");
  EXPECT_FALSE(found.verdict);
}

// A displacement that both have, and a force with a law of it and noise.
std::filesystem::path table(const test::TemporaryFolder& folder, const char* name, unsigned seed,
                            double cubic) {
  std::mt19937 random{seed};
  std::normal_distribution<double> noise{0, 300};
  std::string text = "time [s],displ [m],force [N]\n";
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.002 * i, u = 0.02 * (std::sin(3 * t) + 0.6 * std::sin(7.3 * t + 1));
    text +=
        fmt::format("{:.3f},{:.9g},{:.9g}\n", t, u, 4e6 * u + cubic * u * u * u + noise(random));
  }
  return folder.write(name, text);
}

TEST(PairOfTables, HasTheTermThatTheOtherHasInAddition) {
  const test::TemporaryFolder folder;
  const auto a = table(folder, "a.csv", 1, 0), b = table(folder, "b.csv", 2, 3e9);
  const auto found = why(report::compare(a, b, {}));

  ASSERT_TRUE(found.verdict);
  ASSERT_EQ(found.verdict->conclusion.causes.size(), 1U) << found.sentence;
  const auto& stiffness = found.verdict->conclusion.causes[0].parameters.at(0);
  EXPECT_NEAR(stiffness.value, 3e9, 1e8);  // noise of 300 N beside 10 kN
}

TEST(PairOfTables, HasNoCauseIfOnlyTheNoiseDiffers) {
  const test::TemporaryFolder folder;
  const auto a = table(folder, "a.csv", 1, 0), b = table(folder, "b.csv", 2, 0);
  const auto found = why(report::compare(a, b, {}));

  ASSERT_TRUE(found.verdict);
  EXPECT_TRUE(found.verdict->conclusion.causes.empty()) << found.sentence;
}

/// A hidden change, and the cause that names it; that of the motion has no term.
struct Hidden {
  const char* name;
  Overrides changes;
  const char* cause;
};

std::vector<Hidden> hidden_changes() {
  return {
      {"heating", {{"specimen.lead_heating.enabled", "false"}}, "lead_heating"},
      {"drag", {{"machine.quadratic_drag.coefficient_N_s2_per_m2", "6e4"}}, "quadratic_drag"},
      {"gain", {{"machine.gain", "{kind = 'gain', factor = 1.04}"}}, "force_gain"},
      {"displacement_gain",
       {{"machine.gain", "{kind = 'gain', channel = 'displacement', factor = 1.03}"}},
       "displacement_gain"},
      {"skew", {{"machine.time_skew", "{channel = 'force', skew_s = 0.002}"}}, "force_time_skew"},
      {"delay", {{"machine.actuator_delay.delay_s", "0.01"}}, ""},
      {"offset", {{"machine.offset", "{channel = 'force', offset_N = 3e4}"}}, "force_offset"},
      {"crosstalk",
       {{"machine.crosstalk_horizontal", "{lat_into_long = 0.03, long_into_lat = 0.03}"}},
       "crosstalk_horizontal"},
      {"filter",
       {{"machine.filter_lag", "{channel = 'force', time_constant_s = 0.003}"}},
       "force_filter_lag"}};
}

// With that of the unit above, ten pairs. Goal: eight.
TEST_F(PairOfRuns, HasItsHiddenChangeFirstInSevenOfNine) {
  std::size_t named = 0;
  for (const auto& [name, changes, cause] : hidden_changes()) {
    const auto found = why_of(name, changes);
    const bool is_named = *cause == '\0' ? !found.mistakes.empty() : first_cause(found) == cause;
    named += is_named ? 1 : 0;
    if (!is_named) std::printf("%s: %s\n", name, found.sentence.c_str());
  }

  EXPECT_GE(named, 7U);
}

TEST_F(PairOfRuns, HasNoFalseCauseInTenUnchangedOnes) {
  for (int i = 1; i <= 10; ++i) {
    const auto found = why_of("seed_" + std::to_string(i), {{"seed", std::to_string(1992 + i)}});

    EXPECT_EQ(first_cause(found), "") << i;
    EXPECT_TRUE(found.mistakes.empty()) << i;
  }
}

}  // namespace
}  // namespace rths::session

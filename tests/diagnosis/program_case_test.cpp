// SPDX-License-Identifier: Apache-2.0
// The user's simulation is a program that runs during the diagnosis: here a mass on a spring, in
// awk, whose coarse steps no model of this project shares.
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <regex>

#include <gtest/gtest.h>

#include <rths/report/diagnosis.hpp>

#include "dynamic_case.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kPeriod = 0.005, kStiff = 4000;  // of samples [s]; of the spring [N/m]
constexpr std::size_t kRows = 1200, kStill = 400;

// Semi-implicit Euler, one step per sample.
std::vector<double> oscillator(const std::vector<double>& push, double stiffness) {
  std::vector<double> motion;
  double x = 0, v = 0;
  for (const double u : push) {
    v += kPeriod * (u - 16 * v - stiffness * x) / 2;
    x += kPeriod * v;
    motion.push_back(x);
  }
  return motion;
}

constexpr const char* kProgram = R"awk(#!/bin/sh
awk -F, -v k="$(sed 's/.*= //' parameters.toml)" ' NR == 1 {
  print "x";
  next
}
{
  v += 0.005 * ($2 - 16 * v - k * x) / 2;
  x += 0.005 * v;
  printf "%.15g\n", x
}
' inputs.csv > outputs.csv
)awk";

using Distortion = std::function<void(std::vector<double>&)>;

class ProgramCase : public ::testing::Test {
 protected:
  ProgramCase() { write_program(kProgram); }

  void write_program(const std::string& script) const {
    const auto file = folder_.path() / "simulate";
    std::ofstream{file} << script;
    chmod(file.c_str(), 0700);
  }
  // Records of the oscillator, whose input and output an effect may distort.
  void record(double stiffness, const Distortion& input = {}, const Distortion& output = {}) const {
    for (unsigned k = 0; k < 2; ++k) {
      auto push = test_support::random_signal(10 + k, kRows, kPeriod, 0.5, 12, 20);
      std::fill_n(push.begin(), kStill, 0.0);
      auto real_push = push;
      if (input) input(real_push);
      auto measured = oscillator(real_push, stiffness);
      if (output) output(measured);
      const auto noise = test_support::noise(100 + k, kRows, 1.5e-5);
      for (std::size_t i = 0; i < kRows; ++i) measured[i] += noise[i];
      folder_.write(k == 0 ? "fit.csv" : "unseen.csv", {{"u", push}, {"y", measured}});
    }
  }
  [[nodiscard]] Case load(const std::string& more = "") const {
    return folder_.load(R"(format = 1
name = "program"
[[record]]
file = "fit.csv"
use = "fit"
quiet_s = [0, 1.9]
[[record]]
file = "unseen.csv"
use = "held_out"
quiet_s = [0, 1.9]
[channels]
rate_Hz = 200
input.u = "u [N]"
output.y = "y [m]"
[model]
kind = "program"
command = ["./simulate"]
)" + more + R"([model.inputs]
"input.u" = "u"
[model.outputs]
"output.y" = "x"
[model.parameters.stiffness]
value = 4000
unit = "N/m"
)");
  }
  [[nodiscard]] Verdict verdict(const std::string& more = "") const { return diagnose(load(more)); }
  [[nodiscard]] std::string error() const {
    return test::error_of([&] { static_cast<void>(verdict()); });
  }

  test_support::CaseFolder folder_;
};

void expect_only(const Verdict& verdict, const std::string& name, const std::string& channel) {
  ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, name) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].channel, channel) << verdict.sentence;
  const RecordScore& proof = verdict.evaluation.fit.back();
  EXPECT_LT(proof.nrmse_after, 1.25 * proof.noise_floor) << verdict.sentence;
}

TEST_F(ProgramCase, IsSilentIfNothingIsMissing) {
  record(kStiff);

  const Verdict silent = verdict();

  EXPECT_EQ(silent.conclusion.outcome, Outcome::None) << silent.sentence;
  EXPECT_TRUE(std::any_of(silent.limits.begin(), silent.limits.end(), [](const auto& limit) {
    return limit.starts_with("The simulation ran ") &&
           limit.ends_with(" times, of 20000 that are allowed (most_runs).");
  }));
}

TEST_F(ProgramCase, NamesAnEffectAtAnInput) {
  record(kStiff, [](auto& u) {
    for (double& value : u) value = std::clamp(value, -32.0, 32.0);
  });

  const Verdict found = verdict();

  expect_only(found, "saturation", "input.u");
  EXPECT_NEAR(found.conclusion.causes[0].parameters[0].value, 32, 0.3);
}

TEST_F(ProgramCase, NamesAnEffectAtAnOutput) {
  record(kStiff, {}, [](auto& y) {
    for (double& value : y) value = std::abs(value);
  });

  expect_only(verdict(), "absolute_value_sensor", "output.y");
}

TEST_F(ProgramCase, FindsAWrongParameterAndRunsImproved) {
  record(4200);

  const Verdict found = verdict();
  expect_only(found, "parameter_error", "stiffness");
  EXPECT_NEAR(found.conclusion.causes[0].parameters[0].value, 4200, 5);
  const auto files = report::write_diagnosis(found, folder_.path() / "out");

  ASSERT_TRUE(files.improved);
  const Verdict improved = diagnose(load_case(*files.improved));
  EXPECT_EQ(improved.conclusion.outcome, Outcome::None) << improved.sentence;
}

TEST_F(ProgramCase, FitsItsParameters) {
  record(4200);

  const Verdict fitted = verdict("fitted = [\"stiffness\"]\n");

  EXPECT_EQ(fitted.conclusion.outcome, Outcome::None) << fitted.sentence;
  ASSERT_EQ(fitted.evaluation.refitted.size(), 1U);
  EXPECT_NEAR(fitted.evaluation.refitted[0].after, 4200, 5);
}

// A small change of the stiffness changes nothing, or all that ten of it do.
TEST_F(ProgramCase, FitsAParameterThatItsOutputsFollowInSteps) {
  write_program(std::regex_replace(kProgram, std::regex{"k \\* x"}, "10 * int(k / 10) * x"));
  record(4200);

  const Verdict fitted = verdict("fitted = [\"stiffness\"]\n");

  EXPECT_EQ(fitted.conclusion.outcome, Outcome::None) << fitted.sentence;
  EXPECT_NEAR(fitted.evaluation.refitted.at(0).after, 4200, 10);
}

TEST_F(ProgramCase, IsRefusedIfItDoesNotPredict) {
  record(kStiff);
  const std::string name = (folder_.path() / "simulate").string();

  write_program("#!/bin/sh\necho no licence; exit 4\n");
  EXPECT_EQ(error(), "fit.csv: " + name + ": ended with exit code 4; it wrote: no licence");
  write_program("#!/bin/sh\n(echo y; seq 1200) > outputs.csv\n");
  EXPECT_EQ(error(), "fit.csv: " + name + ": outputs.csv has no column 'x', only y");
  write_program("#!/bin/sh\n(echo x; seq 1199; date +%N | sed 's/^0*//') > outputs.csv\n");
  EXPECT_NE(error().find("fit.csv: two runs with the same inputs differ by up to"),
            std::string::npos);
  write_program(kProgram);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(verdict("deadline = 1\n"));
            }).find("unknown key 'deadline'"),
            std::string::npos);
}

TEST_F(ProgramCase, EndsWhenItsRunsAreSpent) {
  record(4200);

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(verdict("most_runs = 5\n"));
            }).find("allow more (most_runs)"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::diagnosis

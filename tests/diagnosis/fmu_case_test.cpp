// SPDX-License-Identifier: Apache-2.0
// The user's simulation is an FMU: a mass on a spring, whose steps no model of this project shares.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "dynamic_case.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kPeriod = 0.005, kStiff = 2000,
                 kDamping = 8;  // of a unit mass [s], [N/m], [N·s/m]
constexpr int kSteps = 5;       // of the FMU per sample
constexpr std::size_t kRows = 1200, kStill = 400;

// The method of the FMU.
std::vector<double> oscillator(const std::vector<double>& push) {
  const double h = kPeriod / kSteps;
  std::vector<double> motion{0};
  double x = 0, v = 0;
  for (std::size_t row = 0; row + 1 < push.size(); ++row) {
    for (int i = 0; i < kSteps; ++i) {
      const double mean = push[row] + (push[row + 1] - push[row]) * (i + 0.5) / kSteps;
      const double a = mean - kStiff * x - kDamping * v;
      v += h * a;
      x += h * (v - h / 2 * a);
    }
    motion.push_back(x);
  }
  return motion;
}

class FmuCase : public ::testing::Test {
 protected:
  FmuCase() {
    const auto binaries = folder_.path() / "mass/binaries/linux64";
    std::filesystem::create_directories(binaries);
    std::filesystem::copy(test::build_tree() / "fmu2/mass.so", binaries / "mass.so");
    std::ofstream{folder_.path() / "mass/modelDescription.xml"} << R"(<fmiModelDescription
 fmiVersion="2.0" modelName="Mass" guid="1"><CoSimulation modelIdentifier="mass"/>
<UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit></UnitDefinitions>
<ModelVariables>
<ScalarVariable name="x" valueReference="0" causality="output" variability="continuous" initial="exact"><Real unit="m" start="0"/></ScalarVariable>
<ScalarVariable name="v" valueReference="1" causality="output" variability="continuous" initial="exact"><Real unit="m/s" start="0"/></ScalarVariable>
<ScalarVariable name="F" valueReference="2" causality="input"><Real unit="N" start="0"/></ScalarVariable>
<ScalarVariable name="k" valueReference="3" causality="parameter"><Real unit="N/m" start="2000"/></ScalarVariable>
<ScalarVariable name="c" valueReference="4" causality="parameter"><Real unit="N.s/m" start="8"/></ScalarVariable>
<ScalarVariable name="e" valueReference="5" causality="parameter"><Real start="0"/></ScalarVariable>
</ModelVariables></fmiModelDescription>)";
  }

  void record() const {
    for (unsigned k = 0; k < 2; ++k) {
      auto push = test_support::random_signal(10 + k, kRows, kPeriod, 0.5, 12, 20);
      std::fill_n(push.begin(), kStill, 0.0);
      auto measured = oscillator(push);
      const auto noise = test_support::noise(100 + k, kRows, 2e-5);
      for (std::size_t i = 0; i < kRows; ++i) measured[i] += noise[i];
      folder_.write(k == 0 ? "fit.csv" : "unseen.csv", {{"u", push}, {"y", measured}});
    }
  }
  [[nodiscard]] Verdict verdict(const std::string& port) const {
    return diagnose(folder_.load(R"(format = 1
name = "fmu"
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
input.push = "u [N]"
output.y = "y [m]"
[model]
kind = "fmu"
file = "mass"
step_s = 0.001
[model.inputs]
"input.push" = "F"
[model.outputs]
"output.y" = "x"
[model.parameters.k]
[model.parameters.c]
[model.port.spring]
displacement = "x"
velocity = "v"
)" + port));
  }

  test_support::CaseFolder folder_;
};

// Heights of a ball that falls from 1 m, with air drag, by the method of the FMU.
std::vector<double> ball(double restitution, double drag) {
  const double h = 0.001;
  std::vector<double> heights;
  double x = 1, v = 0;
  for (int i = 0; i <= 1300; ++i) {
    if (i % 10 == 0) heights.push_back(x);
    const double a = -9.81 - drag * std::abs(v) * v;
    v += h * a;
    x += h * (v - h / 2 * a);
    if (x <= 0 && v < 0) x = 0, v *= -restitution;
  }
  return heights;
}

constexpr const char* kAtInput = "force = \"F\"\n";

TEST_F(FmuCase, IsSilentIfNothingIsMissing) {
  record();

  const Verdict silent = verdict(kAtInput);

  EXPECT_EQ(silent.conclusion.outcome, Outcome::None) << silent.sentence;
}

// Its outputs jump with its parameters where a bounce moves by a step.
TEST_F(FmuCase, OfABallThatBouncesLacksDrag) {
  for (unsigned k = 0; k < 3; ++k) {
    auto heights = ball(0.7, 0.08);
    const auto noise = test_support::noise(k, heights.size(), 2e-3);
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += noise[i];
    folder_.write(fmt::format("drop{}.csv", k), {{"y", heights}});
  }

  const Verdict found = diagnose(folder_.load(R"(format = 1
name = "ball"
[[record]]
file = "drop0.csv"
use = "fit"
[[record]]
file = "drop1.csv"
use = "held_out"
[[record]]
file = "drop2.csv"
use = "held_out"
[channels]
rate_Hz = 100
output.y = "y [m]"
[noise]
"output.y" = "0.002 [m]"
[model]
kind = "fmu"
file = "mass"
step_s = 0.001
fitted = ["e"]
[model.outputs]
"output.y" = "x"
[model.start]
x = 1
F = -9.81
k = 0
c = 0
[model.parameters.e]
value = 0.68
bounds = [0.5, 1]
[model.port.air]
displacement = "x"
state = "v"
)"));

  ASSERT_EQ(found.conclusion.causes.size(), 1U) << found.sentence;
  EXPECT_EQ(found.conclusion.causes[0].name, "quadratic_drag") << found.sentence;
  EXPECT_NEAR(found.conclusion.causes[0].parameters[0].value, 0.08, 0.004);
  EXPECT_NEAR(found.evaluation.refitted.at(0).after, 0.7, 0.003);
}

TEST_F(FmuCase, IsRefusedIfUnitsOrPortsAreWrong) {
  record();
  const auto error = [&](const std::string& port) {
    return test::error_of([&] { static_cast<void>(verdict(port)); });
  };

  EXPECT_NE(error("").find("expected one of force and state"), std::string::npos) << error("");
  EXPECT_NE(error("force = \"G\"\n").find("the FMU has no variable 'G'"), std::string::npos);
}

}  // namespace
}  // namespace rths::diagnosis

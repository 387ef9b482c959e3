// SPDX-License-Identifier: Apache-2.0
//
// FMUs as simulations of users: rows of inputs in, rows of outputs out, each run in its own
// process.
#include <rths/foreign/fmu.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include "test_fmu.hpp"

namespace rths::foreign {
namespace {

constexpr double kStep = 1e-3, kLag = 0.01;  // [s]

FmuSettings lag_settings(const std::filesystem::path& file) {
  FmuSettings settings;
  settings.file = file;
  settings.inputs = {"u"};
  settings.outputs = {"y"};
  settings.parameters = {"gain"};
  settings.deadline = 20;
  return settings;
}

RunInputs ramp(std::size_t rows, double interval, double gain) {
  RunInputs inputs{5, interval, rows, {{}}, {gain}, {}};
  for (std::size_t row = 0; row < rows; ++row)
    inputs.inputs[0].push_back(0.002 * static_cast<double>(row));
  return inputs;
}

class FmuSimulationOf : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] std::string trouble_of(const std::string& name, double deadline = 20) const {
    auto settings = lag_settings(test::lag_fmu(folder_, GetParam(), name));
    settings.deadline = deadline;
    const std::string start = settings.file.string() + ": ";
    const std::string trouble = make_fmu(settings)->run(ramp(200, kStep, 1)).trouble;
    EXPECT_EQ(trouble.substr(0, start.size()), start);
    return trouble.substr(std::min(start.size(), trouble.size()));
  }

  test::TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Fmi, FmuSimulationOf, ::testing::Values(2, 3));

TEST_P(FmuSimulationOf, TakesMeansOfInputsAndReturnsOutputsInSi) {
  const auto simulation = make_fmu(lag_settings(test::lag_fmu(folder_, GetParam(), "correct")));

  const RunOutputs result = simulation->run(ramp(20, kStep, 3));

  ASSERT_EQ(result.trouble, "");
  double expected = 0;
  for (std::size_t row = 1; row < 20; ++row) {
    const double mean = 0.002 * (static_cast<double>(row) - 0.5);
    expected += (3 * mean - expected) * kStep / (kStep + kLag);
    EXPECT_NEAR(result.outputs[0][row], expected, 1e-15) << row;
  }
}

TEST_P(FmuSimulationOf, InterpolatesItsOwnSteps) {
  auto settings = lag_settings(test::lag_fmu(folder_, GetParam(), "correct"));
  const RunOutputs fine = make_fmu(settings)->run(ramp(40, kStep, 1));
  settings.step = kStep;

  const RunOutputs coarse =
      make_fmu(settings)->run({5, 1.5e-3, 20, {{ramp(20, kStep, 1).inputs[0]}}, {1}, {}});

  // A ramp of two thirds of the slope, at every 1.5 steps.
  for (std::size_t row = 0; row + 1 < 20; row += 2)
    EXPECT_NEAR(coarse.outputs[0][row], fine.outputs[0][row * 3 / 2] * 2 / 3, 1e-12);
  EXPECT_NEAR(coarse.outputs[0][1], (fine.outputs[0][1] + fine.outputs[0][2]) / 3, 1e-12);
}

TEST_P(FmuSimulationOf, ReportsWhyItHasNoOutputs) {
  const std::string fmi = "fmi" + std::to_string(GetParam());
  EXPECT_EQ(trouble_of("fails_step"),
            fmi + "DoStep returned " + fmi + "Error at 0.1 s: the pump is off");
  EXPECT_EQ(trouble_of("writes_nan"), "'y' is nan at 0.101 s, expected a finite number");
  EXPECT_EQ(trouble_of("crashes"), "was ended by signal 11 (Segmentation fault)");
  EXPECT_EQ(trouble_of("loops", 0.5), "did not end within 0.5 s (deadline_s)");
  EXPECT_EQ(trouble_of("terminates"), "asks for its end at 0.1 s");
  EXPECT_EQ(trouble_of("initialization_fails"),
            fmi + "ExitInitializationMode returned " + fmi + "Error at 0 s: no equilibrium");
}

TEST_P(FmuSimulationOf, RefusesVariablesThatItCannotUse) {
  const auto error = [&](const auto& change) {
    auto settings = lag_settings(test::lag_fmu(folder_, GetParam(), "correct"));
    change(settings);
    return test::error_of([&] { static_cast<void>(make_fmu(settings)); });
  };

  EXPECT_NE(error([](auto& s) { s.inputs = {"w"}; }).find("the FMU has no variable 'w'"),
            std::string::npos);
  EXPECT_EQ(error([](auto& s) { s.inputs = {"y"}; }), "'y' has causality output, expected input");
  EXPECT_EQ(error([](auto& s) { s.outputs = {"title"}; }),
            "'title' is an array, clocked or of type String, expected a scalar number");
  EXPECT_EQ(error([](auto& s) { s.parameters = {"y"}; }),
            "'y' has causality output, expected parameter, input or initial = \"exact\"");
  EXPECT_EQ(
      error([](auto& s) {
        s.ports = {{"y", "", "", "y"}};
      }),
      "'y' is no state that can be set: expected initial = \"exact\", causality output or local");
}

// ---- ports ------------------------------------------------------------------------------------

constexpr double kSpring = 100;  // [N/m], of a unit mass

class SpringForces final : public PortForces {
 public:
  double next(std::size_t /*port*/, const PortMotion& motion) override {
    return kSpring * motion.displacement;
  }
};

PortLaw spring() {
  return {"spring", [](double /*time_step*/) { return std::make_unique<SpringForces>(); }};
}

class FmuPorts : public ::testing::Test {
 protected:
  [[nodiscard]] FmuSettings mass(const std::string& library) const {
    const std::string description =
        R"(<fmiModelDescription fmiVersion="2.0" modelName="Mass" guid="1">
<CoSimulation modelIdentifier=")" +
        library + R"("/><ModelVariables>
<ScalarVariable name="x" valueReference="0" causality="output" variability="continuous" initial="exact"><Real start="0"/></ScalarVariable>
<ScalarVariable name="v" valueReference="1" causality="output" variability="continuous" initial="exact"><Real start="0"/></ScalarVariable>
<ScalarVariable name="F" valueReference="2" causality="input"><Real start="0"/></ScalarVariable>
</ModelVariables></fmiModelDescription>)";
    FmuSettings settings;
    settings.file = test::write_fmu(folder_, description, test::lag_library(2, library), 2);
    settings.outputs = {"x", "v"};
    settings.start = {{"x", 0.1}};
    return settings;
  }

  test::TemporaryFolder folder_;
};

// x = 0.1 cos 10 t, v = −sin 10 t. Steps of 1 ms: errors of second order, (10 · 1e-3)² · 10 rad.
void expect_oscillation(const RunOutputs& result) {
  ASSERT_EQ(result.trouble, "");
  for (std::size_t row = 0; row < 1000; ++row) {
    const double angle = 10 * kStep * static_cast<double>(row);
    ASSERT_NEAR(result.outputs[0][row], 0.1 * std::cos(angle), 1e-4) << row;
    ASSERT_NEAR(result.outputs[1][row], -std::sin(angle), 1e-3) << row;
  }
}

TEST_F(FmuPorts, TakeAForceFromAnInput) {
  FmuSettings settings = mass("mass");
  settings.ports = {{"x", "v", "F", ""}};

  expect_oscillation(make_fmu(settings)->run({0, kStep, 1000, {}, {}, spring()}));
}

TEST_F(FmuPorts, ChangeAStateAtEachStep) {
  FmuSettings settings = mass("mass");
  settings.ports = {{"x", "", "", "v"}};

  expect_oscillation(make_fmu(settings)->run({0, kStep, 1000, {}, {}, spring()}));
}

TEST_F(FmuPorts, DoNotChangeARunWithoutForces) {
  FmuSettings settings = mass("mass");
  const RunInputs free{0, kStep, 100, {}, {}, {}};
  const RunOutputs without = make_fmu(settings)->run(free);
  settings.ports = {{"x", "", "", "v"}};

  EXPECT_EQ(make_fmu(settings)->run(free).outputs, without.outputs);
}

TEST_F(FmuPorts, RefuseAnFmuWithStatesThatCannotBeSet) {
  FmuSettings settings = mass("hidden_state");
  settings.inputs = {"F"};
  settings.ports = {{"x", "", "", "v"}};

  const RunInputs pushed{0, kStep, 100, {std::vector<double>(100, 1.0)}, {}, {}};

  EXPECT_NE(make_fmu(settings)->run(pushed).trouble.find(
                "a start at each step, for the port at a state, changes 'x' by "),
            std::string::npos);
}

}  // namespace
}  // namespace rths::foreign

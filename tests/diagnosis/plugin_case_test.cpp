// SPDX-License-Identifier: Apache-2.0
// The user's simulation is a plugin: a mass on a spring, whose steps no model of this project
// shares.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/foreign/plugin.hpp>
#include <rths/verdict/diagnose.hpp>

#include "dynamic_case.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kPluginPeriod = 0.005, kPluginStiffness = 2000,
                 kPluginDamping = 8;  // [s], [N/m], [N·s/m]
constexpr int kPluginSteps = 5;       // of the plugin per sample
constexpr std::size_t kPluginRows = 1200, kPluginStill = 400;

// The method of the plugin, with the drag of the velocity in the middle of each step.
std::vector<double> pushed_mass(const std::vector<double>& push, double mass, double drag) {
  const double h = kPluginPeriod / kPluginSteps;
  std::vector<double> motion{0};
  double x = 0, v = 0;
  for (std::size_t row = 0; row + 1 < push.size(); ++row) {
    for (int i = 0; i < kPluginSteps; ++i) {
      const double mean = push[row] + (push[row + 1] - push[row]) * (i + 0.5) / kPluginSteps;
      const double a = (mean - kPluginStiffness * x - kPluginDamping * v) / mass;
      const double middle = v + h / 2 * (a - drag * std::abs(v) * v / mass);
      const double slowed = a - drag * std::abs(middle) * middle / mass;
      v += h * slowed;
      x += h * (v - h / 2 * slowed);
    }
    motion.push_back(x);
  }
  return motion;
}

class PluginCase : public ::testing::Test {
 protected:
  void record(double mass, double drag) const {
    for (unsigned k = 0; k < 2; ++k) {
      auto push = test_support::random_signal(10 + k, kPluginRows, kPluginPeriod, 0.5, 12, 20);
      std::fill_n(push.begin(), kPluginStill, 0.0);
      auto measured = pushed_mass(push, mass, drag);
      const auto noise = test_support::noise(100 + k, kPluginRows, 2e-5);
      for (std::size_t i = 0; i < kPluginRows; ++i) measured[i] += noise[i];
      folder_.write(k == 0 ? "fit.csv" : "unseen.csv", {{"u", push}, {"y", measured}});
    }
  }
  // @param model  lines of [model]  @param tables  below it
  [[nodiscard]] Verdict verdict(const std::string& model, const std::string& tables = "",
                                const std::string& file = "oscillator/mass.so") const {
    return diagnose(folder_.load(fmt::format(R"(format = 1
name = "plugin"
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
kind = "plugin"
file = "{}"
{}
[model.config]
mass_kg = 1.0
[model.inputs]
"input.push" = "lab.push"
[model.outputs]
"output.y" = "lab.displ"
{})",
                                             (test::build_tree() / file).string(), model, tables)));
  }
  [[nodiscard]] std::string error_of(const std::string& model, const std::string& tables = "",
                                     const std::string& file = "oscillator/mass.so") const {
    return test::error_of([&] { static_cast<void>(verdict(model, tables, file)); });
  }

  test_support::CaseFolder folder_;
};

constexpr const char* kPluginStep = "step_s = 0.001";

TEST_F(PluginCase, IsSilentIfNothingIsMissing) {
  record(1, 0);

  const Verdict silent = verdict(kPluginStep);

  EXPECT_EQ(silent.conclusion.outcome, Outcome::None) << silent.sentence;
}

TEST_F(PluginCase, LacksDragAtAPort) {
  constexpr double kDrag = 4;
  record(1, kDrag);

  const Verdict found = verdict(kPluginStep, R"([model.port.air]
displacement = "lab.displ"
velocity = "velocity"
force = "lab.push")");

  ASSERT_EQ(found.conclusion.causes.size(), 1U) << found.sentence;
  EXPECT_EQ(found.conclusion.causes[0].name, "quadratic_drag") << found.sentence;
  EXPECT_NEAR(found.conclusion.causes[0].parameters[0].value, kDrag, 0.03 * kDrag);
}

// Stiffness and damping are signals of the plugin, the mass is a key of its configuration.
TEST_F(PluginCase, IsRefittedInSignalsAndConfiguration) {
  record(1.08, 0);

  const Verdict fitted = verdict(fmt::format("{}\nfitted = [\"config.mass_kg\"]", kPluginStep),
                                 R"([model.parameters.stiffness]
[model.parameters."config.mass_kg"]
value = 1.0
unit = "kg")");

  EXPECT_EQ(fitted.conclusion.outcome, Outcome::None) << fitted.sentence;
  ASSERT_EQ(fitted.evaluation.refitted.size(), 1U);
  EXPECT_NEAR(fitted.evaluation.refitted[0].after, 1.08, 0.003);
}

TEST_F(PluginCase, IsRefusedIfItCannotBeRun) {
  record(1, 0);
  const auto has = [](const std::string& error, const std::string& text) {
    EXPECT_NE(error.find(text), std::string::npos) << error;
  };
  has(error_of("step_s = 0.003"), "step_s is 0.003, expected the interval of the record, 0.005 s");
  has(error_of("", "[model.start]\n\"lab.psh\" = 1"),
      "the plugin has no input or parameter 'lab.psh' (did you mean 'lab.push'?)");
  has(error_of("", "[model.port.air]\ndisplacement = \"lab.disp\"\nforce = \"lab.push\""),
      "the plugin has no output or monitor 'lab.disp' (did you mean 'lab.displ'?)");
  has(error_of("", "[model.port.air]\ndisplacement = \"lab.displ\"\nstate = \"velocity\""),
      "force");
  has(error_of("", "", "oscillator/two_inputs.so"), "input 'lab.pull' has no value");
  has(error_of("", "", "oscillator/none.so"), "is not a file");
  has(error_of("", "", "broken/no_entry.so"), "exports no rths_adapter_entry");
  has(error_of("", "", "broken/create_fails.so"), "create failed: ");
  has(error_of("deadline_s = 0.5", "", "broken/create_loops.so"), "did not end within 0.5 s");
}

std::vector<foreign::PluginSignal> signals_of(const foreign::PluginRunSettings& settings) {
  return foreign::plugin_signals(settings.file, settings.config, settings.deadline);
}

TEST(PluginRun, EndsWithThePluginsReason) {
  foreign::PluginRunSettings settings;
  settings.file = test::build_tree() / "oscillator/mass.so";
  settings.config = "mass_kg = 1.0";
  settings.inputs = {"lab.push"};
  settings.outputs = {"lab.displ"};
  settings.parameters = {"stiffness"};
  const auto simulation = foreign::make_plugin(settings, signals_of(settings));
  foreign::RunInputs inputs{0, 0.1, 100, {std::vector<double>(100, 1.0)}, {-1e5}, {}};

  EXPECT_NE(simulation->run(inputs).trouble.find("returned RTHS_FAULT at "), std::string::npos);
  EXPECT_NE(simulation->run(inputs).trouble.find("the spring broke"), std::string::npos);

  inputs.parameters = {0};
  const auto free = simulation->run(inputs);
  EXPECT_EQ(free.trouble, "");
  EXPECT_EQ(free.outputs.at(0).at(0), 0);
}

// A plugin that crashes ends its run, not the diagnosis.
TEST(PluginRun, SurvivesACrash) {
  foreign::PluginRunSettings settings;
  settings.file = test::build_tree() / "broken/step_crashes.so";
  settings.inputs = {"xpc.long.displ.ref"};
  settings.outputs = {"srmd.long.displ.fbk"};
  const auto simulation = foreign::make_plugin(settings, signals_of(settings));
  const foreign::RunInputs inputs{0, 0.001, 1000, {std::vector<double>(1000, 0.0)}, {}, {}};

  EXPECT_NE(simulation->run(inputs).trouble.find("was ended by signal 11"), std::string::npos);
}

}  // namespace
}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
//
// The prediction of a pretest against the run that it predicts. Long.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::commissioning {
namespace {

using Report = nlohmann::json;

test::Finished shell(const std::string& script, const std::filesystem::path& folder) {
  const std::string setup = "set -e\nexport PATH=" + (test::build_tree() / "bin").string() +
                            ":$PATH EXAMPLES=" + (test::source_tree() / "examples").string() +
                            "\ncd " + folder.string() + "\n";
  return test::Running{{"/bin/bash", "-c", setup + script}}.wait(1000);
}

/// An example, and what gives the simulation the specimen and the friction of the laboratory. The
/// responses then differ by the transfer system and the measurement of the force alone.
struct Predicted {
  const char* example;
  const char* same;
};

class PretestOfExample : public ::testing::TestWithParam<Predicted> {};
INSTANTIATE_TEST_SUITE_P(
    Machines, PretestOfExample,
    ::testing::Values(Predicted{"srmd_lprb_2d",
                                " --set model.specimen.lead_heating.enabled=true"
                                " --set model.machine.load_dependent_friction.enabled=true"},
                      Predicted{"srmd_platen_2d",
                                " --set model.specimen.lead_heating.enabled=true"}),
    [](const auto& chosen) { return chosen.param.example; });

// A single run scatters by a quarter of the mean, the mean of four by an eighth.
TEST_P(PretestOfExample, PredictsTheDifferenceOfRunsWithinAFactorOfOneAndAHalf) {
  const test::TemporaryFolder folder;
  const std::string experiment =
      std::string{"$EXAMPLES/"} + GetParam().example + ".toml" + GetParam().same;
  constexpr int kRuns = 4;

  const auto predicted = shell("rths pretest " + experiment + " --json", folder.path());
  const auto ran =
      shell("for seed in 1 2 3 4; do rths run " + experiment +
                " --clock virtual --no-diagnosis --set 'uncompensated={}' --set seed=$seed "
                "--out run$seed; done",
            folder.path());

  ASSERT_EQ(predicted.exit_code, 0) << predicted.out << predicted.err;
  ASSERT_LE(ran.exit_code, 1) << ran.err;
  const auto prediction = Report::parse(predicted.out);
  EXPECT_EQ(prediction["loop_machine"], "the identified machine");
  for (const char* axis : {"long", "lat"}) {
    double mean = 0;
    for (int seed = 1; seed <= kRuns; ++seed) {
      const auto file = folder.path() / ("run" + std::to_string(seed)) / "report.json";
      mean += Report::parse(test::content_of(file))["axes"][axis]["numerical_difference_percent"]
                  .get<double>() /
              kRuns;
    }
    const double ratio = prediction["axes"][axis]["difference_percent"].get<double>() / mean;
    EXPECT_GT(ratio, 1 / 1.5) << axis;
    EXPECT_LT(ratio, 1.5) << axis;
  }
}

}  // namespace
}  // namespace rths::commissioning

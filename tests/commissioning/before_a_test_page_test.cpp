// SPDX-License-Identifier: Apache-2.0
//
// The commands of docs/before_a_test.md in the order of the page, and the prediction of a pretest
// against the run that it predicts. Long.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::commissioning {
namespace {

using Report = nlohmann::json;

std::string commands_of(const std::string& page) {
  const std::string begin = "```sh\n";
  const auto at = page.find(begin) + begin.size();
  return page.substr(at, page.find("```", at) - at);
}

test::Finished shell(const std::string& script, const std::filesystem::path& folder) {
  const std::string setup = "set -e\nexport PATH=" + (test::build_tree() / "bin").string() +
                            ":$PATH EXAMPLES=" + (test::source_tree() / "examples").string() +
                            "\ncd " + folder.string() + "\n";
  return test::Running{{"/bin/bash", "-c", setup + script}}.wait(1000);
}

TEST(BeforeATestPage, HasCommandsThatWorkInItsOrderAndEndWithGo) {
  const test::TemporaryFolder folder;
  const auto page = test::content_of(test::source_tree() / "docs/before_a_test.md");

  const auto ran = shell(commands_of(page), folder.path());

  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_TRUE(ran.out.ends_with("go\n")) << ran.out;
}

// The laboratory has the specimen and the machine of the simulation, so the response differs by the
// transfer system and the measurement of the force alone.
TEST(Pretest, PredictsTheDifferenceOfARunWithinAFactorOfOneAndAHalf) {
  const test::TemporaryFolder folder;
  const std::string same =
      " --set model.specimen.lead_heating.enabled=true"
      " --set model.machine.load_dependent_friction.enabled=true";

  const auto predicted =
      shell("rths pretest $EXAMPLES/srmd_lprb_2d.toml --json" + same, folder.path());
  const auto ran = shell(
      "rths run $EXAMPLES/srmd_lprb_2d.toml --clock virtual --no-diagnosis "
      "--out run" +
          same,
      folder.path());

  ASSERT_EQ(predicted.exit_code, 0) << predicted.out << predicted.err;
  ASSERT_LE(ran.exit_code, 1) << ran.err;
  const auto prediction = Report::parse(predicted.out)["axes"];
  const auto report = Report::parse(test::content_of(folder.path() / "run/report.json"))["axes"];
  for (const char* axis : {"long", "lat"}) {
    const double ratio = prediction[axis]["difference_percent"].get<double>() /
                         report[axis]["numerical_difference_percent"].get<double>();
    EXPECT_GT(ratio, 1 / 1.5) << axis << " " << prediction[axis] << report[axis];
    EXPECT_LT(ratio, 1.5) << axis << " " << prediction[axis] << report[axis];
  }
}

}  // namespace
}  // namespace rths::commissioning

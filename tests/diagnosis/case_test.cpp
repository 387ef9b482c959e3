// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/case.hpp>

#include <filesystem>

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

constexpr const char* kCase = R"(format = 1
name = "workshop"
[[record]]
file = "fit.csv"
use = "fit"
quiet_s = [0, 0.02]
[[record]]
file = "other.csv"
use = "held_out"
[channels]
time = "t [s]"
displacement.long = "u [mm]"
force.long = "F [kN]"
predicted.force.long = "F_sim [kN]"
[model]
kind = "bearing"
fitted = ["bouc_wen.post_yield_stiffness"]
[model.bouc_wen]
post_yield_stiffness_N_per_m = 4e6
[model.bounds]
"bouc_wen.post_yield_stiffness" = [1e6, 9e6]
[noise]
"force.long" = "2.5 [kN]"
)";
constexpr const char* kLog = "t,u,F,F_sim\n0,0,0,0\n0.01,1,4,5\n0.02,2,8,9\n0.03,3,12,13\n";
constexpr const char* kOtherLog = "t,u,F,F_sim\n0,0,0,0\n0.01,1,4,5\n0.02,2,7,9\n0.03,3,12,13\n";

class CaseTest : public ::testing::Test {
 protected:
  CaseTest() {
    folder_.write("fit.csv", kLog);
    folder_.write("other.csv", kOtherLog);
  }
  Case load(const std::string& toml = kCase) {
    folder_.write("case.toml", toml);
    return load_case(folder_.path());
  }
  std::string error_with(const std::string& before, const std::string& after) {
    std::string toml = kCase;
    toml.replace(toml.find(before), before.size(), after);
    const auto message = test::error_of([&] { static_cast<void>(load(toml)); });
    const auto at = message.rfind(folder_.path().string() + "/");
    return at == std::string::npos ? message : message.substr(folder_.path().string().size() + 1);
  }

  test::TemporaryFolder folder_;
};

TEST_F(CaseTest, ReadsChannelsInSi) {
  const Case c = load();

  ASSERT_EQ(c.records.size(), 2U);
  const Record& fit = c.records[0];
  EXPECT_EQ(fit.use, Use::Fit);
  EXPECT_NEAR(fit.time_step, 0.01, 1e-12);
  EXPECT_EQ(fit.samples(), 4U);
  EXPECT_NEAR(fit.find("displacement.long")->values[2], 2e-3, 1e-15);
  EXPECT_NEAR(fit.find("predicted.force.long")->values[1], 5e3, 1e-9);
  EXPECT_EQ(fit.find("acceleration.long"), nullptr);
  EXPECT_EQ(fit.quiet, (std::pair<std::size_t, std::size_t>{0, 2}));
  EXPECT_EQ(c.noise[0].second, 2.5e3);
}

TEST_F(CaseTest, ReadsTheModelOfTheSimulation) {
  const Model model = load().model;

  EXPECT_EQ(model.kind, ModelKind::Bearing);
  ASSERT_EQ(model.fitted.size(), 1U);
  EXPECT_EQ(model.fitted[0].bounds->second, 9e6);
  EXPECT_TRUE(model.table.is_table("bouc_wen"));
}

TEST_F(CaseTest, IsReadFromTheWorkingDirectory) {
  folder_.write("case.toml", kCase);
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const Case c = load_case("case.toml");
  std::filesystem::current_path(before);

  EXPECT_EQ(c.records.size(), 2U);
  EXPECT_EQ(std::filesystem::canonical(c.source.folder),
            std::filesystem::canonical(folder_.path()));
}

// The improved case has another folder, with the same recordings.
TEST_F(CaseTest, KnowsTheFolderThatItsPathsStartAt) {
  std::filesystem::create_directory(folder_.path() / "data");
  folder_.write("data/fit.csv", kLog);
  folder_.write("data/other.csv", kOtherLog);
  folder_.write("data/simulated.csv", "time,force.long\n0,0\n0.03,12\n");
  const std::string toml = std::string{"folder = \"data\"\n"} + kCase;

  const Case whole = load(toml);
  const Case predicted = load("against = \"simulated.csv\"\n" + toml);

  EXPECT_EQ(std::filesystem::canonical(whole.source.folder),
            std::filesystem::canonical(folder_.path() / "data"));
  EXPECT_EQ(predicted.source.file.text("against"), "simulated.csv");
}

TEST_F(CaseTest, HasTheNameOfItsFolder) {
  std::string toml = kCase;
  toml.erase(toml.find("name"), std::string{"name = \"workshop\"\n"}.size());
  folder_.write("case.toml", toml);
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const Case here = load_case("."), file = load_case("case.toml");
  std::filesystem::current_path(before);

  EXPECT_EQ(here.name, folder_.path().filename());
  EXPECT_EQ(file.name, folder_.path().filename());
  EXPECT_EQ(load(toml).name, folder_.path().filename());
}

TEST_F(CaseTest, RefusesANameWithControlCharacters) {
  EXPECT_EQ(error_with("workshop", R"(workshop\n)"),
            R"(case.toml:2:8: name is 'workshop\n', expected a name without control characters)");
}

TEST_F(CaseTest, RefusesAnEmptyName) {
  EXPECT_EQ(error_with("workshop", ""),
            "case.toml:2:8: name is empty, expected at least one character");
  EXPECT_EQ(error_with("use = \"fit\"", "use = \"fit\"\nname = \"\""),
            "case.toml:6:8: name is empty, expected at least one character");
}

TEST_F(CaseTest, TakesARateInsteadOfTime) {
  std::string toml = kCase;
  toml.replace(toml.find("time = \"t [s]\""), 14, "rate_Hz = 100 ");

  EXPECT_NEAR(load(toml).records[0].time_step, 0.01, 1e-15);
}

TEST_F(CaseTest, ReportsThePositionOfErrors) {
  EXPECT_EQ(error_with("\"u [mm]\"", "\"u\""),
            "case.toml:12:21: 'u' names no unit, expected \"column [unit]\"");
  EXPECT_EQ(error_with("\"u [mm]\"", "\"u [kN]\""),
            "case.toml:12:21: displacement.long is in N, expected m");
  EXPECT_EQ(
      error_with("displacement.long", "displacment.long")
          .find("case.toml:12:20: there is no role 'displacment.long', expected one of command.*"),
      0U);
  EXPECT_NE(error_with("\"u [mm]\"", "\"v [mm]\"").find("there is no column 'v'"),
            std::string::npos);
  EXPECT_NE(error_with("\"u [mm]\"", "\"v [mm]\"").find(", expected one of t, u, F, F_sim"),
            std::string::npos);
  EXPECT_EQ(error_with("displacement.long", "displacement.x"),
            "case.toml:12:18: the model has no axis of 'displacement.x', expected "
            "displacement.long or displacement.lat");
  EXPECT_EQ(error_with("\"held_out\"", "\"unseen\""),
            "case.toml:9:7: use is 'unseen', expected fit, held_out or reference");
  EXPECT_EQ(error_with("\"bearing\"", "\"spring\"").find("case.toml:16:8: there is no model of"),
            0U);
  EXPECT_EQ(error_with("use = \"fit\"", "use = \"reference\""),
            "case.toml:3:1: no [[record]] has use = \"fit\"");
}

// Millimetres that are declared as metres.
TEST_F(CaseTest, RefusesAMotionThatNoMachineReaches) {
  folder_.write("other.csv", "t,u,F,F_sim\n0,0,0,0\n0.01,-50,4,5\n0.02,2,8,9\n");
  const std::string file = (folder_.path() / "other.csv").string();
  std::string toml = kCase;
  toml.replace(toml.find("u [mm]"), 6, "u [m]");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(load(toml)); }),
            (folder_.path() / "case.toml").string() + ":12:21: displacement.long reaches 50 m in " +
                file + ", expected at most 10 m: check its unit");
  const auto model = toml.find("kind");
  toml.replace(model, toml.find("[noise]") - model, "kind = \"data\"\n");
  EXPECT_EQ(load(toml).records[1].find("displacement.long")->values[1], -50);
}

TEST_F(CaseTest, NamesTheColumnWithAnotherUnit) {
  folder_.write("fit.csv", "t,u [cm],F,F_sim\n0,0,0,0\n0.01,1,4,5\n");

  EXPECT_NE(error_with("F_sim [kN]", "F_sim [N]")
                .find("there is no column 'u' (its unit differs in 'u [cm]'), expected one of t, "
                      "u [cm], F, F_sim"),
            std::string::npos);
}

TEST_F(CaseTest, SaysWhichBoundsItFound) {
  EXPECT_EQ(error_with("[1e6, 9e6]", "[9, 1]"),
            "case.toml:21:35: bounds are [9, 1], expected [low, high], low < high");
}

TEST_F(CaseTest, RefusesAParameterThatIsListedTwice) {
  EXPECT_EQ(error_with("fitted = [", "fitted = [\"bouc_wen.post_yield_stiffness\", "),
            "case.toml:17:10: 'bouc_wen.post_yield_stiffness' is listed twice");
}

TEST_F(CaseTest, RefusesNoiseOfNoChannel) {
  EXPECT_EQ(error_with("\"force.long\" =", "\"force.lat\" ="),
            "case.toml:23:15: no record has the channel 'force.lat'");
}

TEST_F(CaseTest, RefusesNoiseOfNoSize) {
  for (const std::string size : {"0", "-1", "1e300"})
    EXPECT_EQ(
        error_with("\"2.5 [kN]\"", "\"" + size + " [kN]\""),
        "case.toml:23:16: standard deviation is " + size + " [kN], expected 1e-50 to 1e+50 in SI");
}

TEST_F(CaseTest, NamesThePathThatCannotBeRead) {
  const auto loop = folder_.path() / "loop.toml";
  std::filesystem::create_symlink(loop, loop);
  for (const auto& path : {loop, folder_.path() / "none", folder_.path() / "none.toml"})
    EXPECT_EQ(test::error_of([&] {
                static_cast<void>(load_case(path));
              }).find(path.string() + ": cannot be read: "),
              0U);
}

TEST_F(CaseTest, RefusesNumbersWhoseSquaresAreNot) {
  EXPECT_EQ(error_with("4e6", "1e300"),
            "case.toml:19:32: post_yield_stiffness_N_per_m is 1e+300, expected 0 or a size from "
            "1e-100 to 1e+100");
  EXPECT_EQ(error_with("[1e6, 9e6]", "[1e-300, 9e6]"),
            "case.toml:21:36: bouc_wen.post_yield_stiffness is 1e-300, expected 0 or a size from "
            "1e-100 to 1e+100");
}

TEST_F(CaseTest, RefusesSamplesThatAreNotEquallySpaced) {
  folder_.write("other.csv", "t,u,F,F_sim\n0,0,0,0\n0.01,1,4,5\n0.025,2,8,9\n0.03,3,1,1\n");

  EXPECT_NE(
      test::error_of([&] { static_cast<void>(load()); })
          .find("row 3 is at 0.025 s, 0.015 s after row 2 at 0.01 s, expected 0.01 s: samples are "
                "not equally spaced; give one record to each section (span_s), or resample_Hz"),
      std::string::npos);
}

}  // namespace
}  // namespace rths::diagnosis

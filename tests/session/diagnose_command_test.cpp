// SPDX-License-Identifier: Apache-2.0
//
// `rths diagnose` and its errors.
#include <signal.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

namespace fs = std::filesystem;
using test::run_rths;

constexpr const char* kEarlier = "{\"format\": 1, \"verdict\": \"none\"}";

TEST(DiagnoseCommand, NeedsACase) {
  const auto run = run_rths({"diagnose"});

  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("case is required"), std::string::npos) << run.err;
}

TEST(DiagnoseCommand, NamesTheFileMissingInAFolder) {
  const test::TemporaryFolder folder;

  const auto run = run_rths({"diagnose", folder.path().string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("case.toml"), std::string::npos) << run.err;
}

TEST(DiagnoseCommand, SaysWhereACaseIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("case.toml", "format = 1\nnam = \"x\"\n");

  const auto run = run_rths({"diagnose", folder.path().string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err.rfind("rths: " + file.string() + ":", 0), 0U) << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << "one line: " << run.err;
}

TEST(DiagnoseCommand, SaysWhereAFittedParameterIsMisspelt) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("case.toml",
                   "format = 1\n[[record]]\nfile = \"a.csv\"\nuse = \"fit\"\n[channels]\n"
                   "time = \"t [s]\"\ndisplacement.long = \"u [mm]\"\nforce.long = \"F [kN]\"\n"
                   "[model]\nkind = \"platen\"\n"
                   "fitted = [\"viscous_friction.coeficient\"]\n"
                   "[model.viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 1\n");
  folder.write("a.csv", "t,u,F\n0,0,1\n0.1,1,2\n0.2,2,3\n0.3,1,2\n0.4,0,1\n");

  const auto run = run_rths({"diagnose", folder.path().string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "rths: " + file.string() +
                         ":11:10: the model has no parameter 'viscous_friction.coeficient' (did "
                         "you mean 'viscous_friction.coefficient'?)\n");
}

TEST(DiagnoseCommand, TakesACaseFile) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("mine.toml", "format = 1\nnam = \"x\"\n");

  const auto run = run_rths({"diagnose", file.string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err.rfind("rths: " + file.string() + ":", 0), 0U) << run.err;
}

TEST(DiagnoseCommand, RefusesSeedsThatAreNoNumbersOf64Bits) {
  for (const char* seed : {"-1", "99999999999999999999", "1.5"}) {
    const auto run = run_rths({"diagnose", "none", "--seed", seed});

    EXPECT_EQ(run.exit_code, 3) << seed;
    EXPECT_NE(run.err.find("--seed"), std::string::npos) << run.err;
  }
}

TEST(DiagnoseCommand, NamesAPathThatCannotBeRead) {
  const test::TemporaryFolder folder;
  const auto loop = folder.path() / "loop";
  std::filesystem::create_symlink(loop, loop);

  const auto run = run_rths({"diagnose", loop.string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err.rfind("rths: " + loop.string() + ": ", 0), 0U) << run.err;
}

TEST(DiagnoseCommand, WritesNothingIfTheCaseIsWrong) {
  const test::TemporaryFolder folder;
  const auto out = folder.path() / "out";

  const auto run = run_rths({"diagnose", (folder.path() / "none").string(), "--out", out.string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(DiagnoseCommand, NamesTheColumnsMissingInASimulation) {
  const test::TemporaryFolder folder;
  folder.write("case.toml",
               "format = 1\n[[record]]\nfile = \"a.csv\"\nuse = \"fit\"\n[channels]\n"
               "time = \"t [s]\"\nforce.long = \"F [kN]\"\n[model]\nkind = \"data\"\n");
  folder.write("a.csv", "t,F\n0,1\n0.1,2\n0.2,3\n");
  const auto sim = folder.write("sim.csv", "time,moment\n0,1\n1,2\n").string();

  const auto run = run_rths({"diagnose", folder.path().string(), "--against", sim});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "rths: " + sim +
                         ": predicts no measured channel, expected columns named "
                         "force.long\n");
}

/// A case in a folder of its own, with the user's files around it.
class DiagnosisBesideFiles : public ::testing::Test {
 protected:
  /// @param more  further lines of the case file
  void write_case(const std::string& file, const std::string& record,
                  const std::string& more = "") const {
    fs::create_directories((place.path() / record).parent_path());
    place.write(record, kTable);
    place.write(file, more + "format = 1\n[[record]]\nfile = \"" + record +
                          "\"\nuse = \"fit\"\n[channels]\ntime = \"t [s]\"\n"
                          "force.long = \"F [kN]\"\npredicted.force.long = \"P [kN]\"\n");
  }
  /// The message of a diagnosis that is refused and changes no file.
  [[nodiscard]] std::string refusal(const std::string& file, const fs::path& out,
                                    const std::vector<std::string>& options = {}) const {
    const auto before = contents();
    std::vector<std::string> arguments{"diagnose", at(file), "--out", out.string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto run = run_rths(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << "one line: " << run.err;
    EXPECT_EQ(contents(), before);
    return run.err;
  }
  static std::string replaces(const fs::path& input, const fs::path& result) {
    return "rths: " + input.string() + ": is an input of the case, and the results would replace " +
           result.string() + ", expected another folder for them (--out)\n";
  }
  [[nodiscard]] std::string at(const std::string& name) const {
    return (place.path() / name).string();
  }
  [[nodiscard]] std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator{place.path()})
      all[entry.path().string()] = entry.is_regular_file() ? test::content_of(entry.path()) : "";
    return all;
  }

  static constexpr const char* kTable = "t,F,P\n0,1,1\n0.1,2,2\n0.2,3,3\n0.3,2,2\n";
  const test::TemporaryFolder place;
};

TEST_F(DiagnosisBesideFiles, RefusesToReplaceItsRecords) {
  write_case("case.toml", "predictions/r0.csv");
  const auto expected = replaces(at("predictions/r0.csv"), at("predictions"));

  EXPECT_EQ(refusal("", place.path()), expected);
  place.write("verdict.json", kEarlier);
  EXPECT_EQ(refusal("", place.path()), expected);
}

TEST_F(DiagnosisBesideFiles, RefusesToReplaceItsCaseFile) {
  write_case("improved.toml", "a.csv");
  EXPECT_EQ(refusal("improved.toml", place.path()),
            replaces(at("improved.toml"), at("improved.toml")));

  fs::create_directory(place.path() / "improved");
  fs::rename(at("improved.toml"), at("improved/case.toml"));
  fs::rename(at("a.csv"), at("improved/a.csv"));
  EXPECT_EQ(refusal("improved", place.path()), replaces(at("improved/case.toml"), at("improved")));
}

TEST_F(DiagnosisBesideFiles, RefusesToReplaceAPredictionOrASecondFileOfARecord) {
  write_case("case.toml", "a.csv");
  const auto simulation = place.write("next_test.csv", "time,force.long\n0,1\n0.3,2\n").string();
  place.write("verdict.json", kEarlier);
  const auto expected = replaces(simulation, at("next_test.csv"));

  EXPECT_EQ(refusal("", place.path(), {"--against", simulation}), expected);
  write_case("case.toml", "a.csv", "against = \"next_test.csv\"\n");
  EXPECT_EQ(refusal("", place.path()), expected);
  write_case("case.toml", "a.csv");
  place.write("next_test.csv", kTable);
  place.write("case.toml", test::content_of(at("case.toml")) +
                               "displacement.long = \"F [mm] in next_test.csv\"\n");
  EXPECT_EQ(refusal("", place.path()), expected);
}

TEST_F(DiagnosisBesideFiles, FollowsLinksToItsInputs) {
  fs::create_directories(at("out"));
  write_case("case.toml", "data/r0.csv");
  fs::create_symlink("../data", at("out/predictions"));
  EXPECT_EQ(refusal("", at("out")), replaces(at("data/r0.csv"), at("out/predictions")));

  fs::remove(at("out/predictions"));
  fs::create_symlink("../case.toml", at("out/improved.toml"));
  EXPECT_EQ(refusal("", at("out")), replaces(at("case.toml"), at("out/improved.toml")));

  fs::remove(at("out/improved.toml"));
  fs::create_directory(at("out/predictions"));
  fs::rename(at("data/r0.csv"), at("out/predictions/r0.csv"));
  fs::create_symlink("../out/predictions/r0.csv", at("data/r0.csv"));
  EXPECT_EQ(refusal("", at("out")), replaces(at("data/r0.csv"), at("out/predictions")));
}

TEST_F(DiagnosisBesideFiles, RefusesAFolderWithFilesOfTheUser) {
  write_case("case.toml", "a.csv");
  fs::create_directories(at("out/predictions"));
  place.write("out/predictions/mydata.csv", "mine");
  place.write("out/improved.toml", "mine");
  place.write("out/next_test.csv", "mine");
  const auto expected = [&](const std::string& names) {
    return "rths: " + at("out") + ": holds " + names +
           ", which the results would replace, but no verdict.json of an earlier diagnosis, "
           "expected another folder for them (--out)\n";
  };

  EXPECT_EQ(refusal("", at("out")), expected("improved.toml, next_test.csv, predictions"));
  place.write("out/verdict.json", "{\"verdict\": \"guilty\"}");
  EXPECT_EQ(refusal("", at("out")),
            expected("verdict.json, improved.toml, next_test.csv, predictions"));
}

// The records are too short, which the diagnosis itself finds.
TEST_F(DiagnosisBesideFiles, TakesAFolderOfAnEarlierOrKilledDiagnosis) {
  write_case("case.toml", "a.csv");
  fs::create_directories(at("out/predictions"));
  place.write("out/notes.txt", "mine");
  place.write("out/predictions/a.csv.part", "of a killed one");
  EXPECT_EQ(refusal("", at("out")).find("earlier diagnosis"), std::string::npos);

  place.write("out/predictions/mydata.csv", "mine");
  EXPECT_NE(refusal("", at("out")).find("earlier diagnosis"), std::string::npos);
  place.write("out/verdict.json", kEarlier);
  EXPECT_EQ(refusal("", at("out")).find("earlier diagnosis"), std::string::npos);
}

// A run that was started in the background of a script ignores SIGINT; `env` takes that back.
TEST(DiagnoseCommand, LeavesNothingWhenASignalInterruptsIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const test::TemporaryFolder folder;
    folder.write("verdict.json", kEarlier);
    for (const auto& out : {folder.path() / "new" / "results", folder.path()}) {
      test::Running diagnosis{{"/usr/bin/env", "--default-signal", test::rths_command(), "diagnose",
                               (test::source_tree() / "examples/diagnosis/actuator").string(),
                               "--out", out.string()}};
      ASSERT_TRUE(test::comes_true([&] { return std::filesystem::exists(out / ".lock"); }));

      ASSERT_EQ(kill(diagnosis.pid(), signal), 0);
      const auto ended = diagnosis.wait();

      EXPECT_EQ(ended.exit_code, 1) << signal;
      EXPECT_EQ(ended.err, "rths: interrupted\n") << signal;
      EXPECT_EQ(ended.out, "");
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1) << signal;
    EXPECT_EQ(test::content_of(folder.path() / "verdict.json"), kEarlier);
  }
}

}  // namespace
}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
//
// `rths diagnose` and its errors.
#include <signal.h>

#include <iterator>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

using test::run_rths;

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

// A run that was started in the background of a script ignores SIGINT; `env` takes that back.
TEST(DiagnoseCommand, LeavesNothingWhenASignalInterruptsIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const test::TemporaryFolder folder;
    folder.write("verdict.json", "an earlier verdict");
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
    EXPECT_EQ(test::content_of(folder.path() / "verdict.json"), "an earlier verdict");
  }
}

}  // namespace
}  // namespace rths

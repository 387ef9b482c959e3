// SPDX-License-Identifier: Apache-2.0
//
// `rths loop` and `rths terms`.
#include <algorithm>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using test::run_rths;

TEST(LoopCommand, PrintsTheNumbersOfEachCycle) {
  const auto run = run_rths({"loop", "lprb", "--cycles", "2"});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 4) << run.out;
}

TEST(LoopCommand, DrawsAndWritesTheLoop) {
  const test::TemporaryFolder folder;
  const auto svg = (folder.path() / "loop.svg").string();
  const auto csv = (folder.path() / "loop.csv").string();

  const auto run = run_rths({"loop", "lprb", "--svg", svg, "--csv", csv});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(test::content_of(svg).rfind("<svg", 0), 0U);
  EXPECT_EQ(test::content_of(csv).rfind("time_s,displacement_long_m", 0), 0U);
}

TEST(LoopCommand, ChangesATermForOneRun) {
  const auto whole = run_rths({"loop", "lprb"});
  const auto without =
      run_rths({"loop", "lprb", "--set", "bouc_wen.characteristic_strength_N=1e5"});

  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_NE(whole.out, without.out);
}

TEST(LoopCommand, SaysWhichTermsAndParametersABearingHas) {
  const auto error_of = [](const char* change) {
    return run_rths({"loop", "tpfb", "--set", change}).err;
  };
  EXPECT_EQ(error_of("lead_heating.enabled=false"),
            "rths: --set lead_heating.enabled: bearing 'tpfb' has no term 'lead_heating', expected "
            "one of multilinear_axial, pendulum_lift, pressure_dep_sliding, triple_pendulum\n");
  EXPECT_EQ(error_of("triple_pendlum.enabled=false"),
            "rths: --set triple_pendlum.enabled: bearing 'tpfb' has no term 'triple_pendlum' (did "
            "you mean 'triple_pendulum'?)\n");
  EXPECT_NE(
      error_of("triple_pendulum.colour=1")
          .find("--set triple_pendulum.colour: term 'triple_pendulum' has no parameter 'colour', "
                "expected one of "),
      std::string::npos);
  EXPECT_EQ(run_rths({"loop", "tpfb", "--set", "extra.kind=coulomb_friction", "--cycles", "1"}).err,
            "");
}

TEST(LoopCommand, TakesNoMoreStepsForASlowTest) {
  const test::TemporaryFolder folder;
  const auto csv = (folder.path() / "loop.csv").string();

  const auto run =
      run_rths({"loop", "lprb", "--frequency-Hz", "1e-4", "--cycles", "1", "--csv", csv});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string rows = test::content_of(csv);
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 2 + 2 * 20'000);
}

TEST(LoopCommand, RefusesTermsThatComputeTheGivenLoad) {
  const auto run = run_rths({"loop", "lprb", "--set", "elastomeric_axial.enabled=true"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("'elastomeric_axial' needs a vertical displacement"), std::string::npos);
}

TEST(LoopCommand, SaysWhereABearingIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("b.toml", "[bouc_wen]\nstrength_N = 1\n");

  const auto run = run_rths({"loop", file.string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "rths: " + file.string() +
                         ":2:14: unknown key 'strength_N', expected one of axes, beta, channel, "
                         "characteristic_strength_N, coupling, enabled, eta, kind, "
                         "post_yield_stiffness_N_per_m, yield_displacement_m\n");
  EXPECT_NE(run_rths({"loop", "lprx"}).err.find("there is no bearing 'lprx', expected a file or"),
            std::string::npos);
}

TEST(TermsCommand, ListsEveryTermWithItsEquation) {
  const auto run = run_rths({"terms"});

  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("bouc_wen (restoring)"), std::string::npos);
  EXPECT_NE(run_rths({"terms", "bouc_wem"}).err.find("did you mean 'bouc_wen'?"),
            std::string::npos);
}

// The command's output is the page in docs.
TEST(TermsCommand, WritesThePageInDocs) {
  const auto page = run_rths({"terms", "--format", "markdown"}).out;
  const auto committed = test::content_of(test::source_tree() / "docs/terms.md");

  EXPECT_NE(page.find("### bouc_wen"), std::string::npos);
  EXPECT_NE(committed.find(page), std::string::npos) << "./lab pictures rewrites it";
}

TEST(TermsCommand, DrawsEveryTerm) {
  const test::TemporaryFolder folder;

  const auto run = run_rths({"terms", "--draw", folder.path().string()});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const auto& entry : std::filesystem::directory_iterator{folder.path()}) {
    const auto name = entry.path().filename();
    EXPECT_TRUE(std::filesystem::exists(test::source_tree() / "docs/images/terms" / name))
        << name << " is not in docs; ./lab pictures draws it";
  }
}

}  // namespace
}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
//
// rths new adapter: what docs/adapters.md says of other languages and roles than those of its
// commands.
#include <filesystem>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::plugin {
namespace {

/// All commands in one shell.
test::Finished run_commands(const std::string& commands, const std::filesystem::path& folder) {
  const auto build = test::build_tree().string();
  const std::string script = "set -e\nexport PATH=" + build +
                             "/bin:$PATH\nexport CMAKE_GENERATOR=Ninja\ncd " + folder.string() +
                             "\n" + commands;
  return test::Running{{"/bin/bash", "-c", script}}.wait(300);
}

// The exit code of a run that is not conclusive is 1.
TEST(NewAdapter, MakesAControllerInCpp) {
  const test::TemporaryFolder folder;
  const auto ran = run_commands(
      "rths new adapter pilot --role controller --language cpp\ncd pilot\ncmake -B build\n"
      "cmake --build build\nctest --test-dir build\n"
      "rths run experiment.toml --clock virtual --no-diagnosis --out out\n"
      "test -f out/report.html && echo has_report\n",
      folder.path());

  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_NE(ran.out.find("100% tests passed"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("has_report\n"), std::string::npos) << ran.out;
}

// 12 s of the main experiment, in which each template takes the place of the built-in adapter.
TEST(NewAdapter, RunsInTheMainExperimentAsControllerAndAsMachine) {
  const std::string run = "rths run " +
                          (test::source_tree() / "examples/srmd_lprb_2d.toml").string() +
                          " --clock virtual --no-diagnosis --set duration_s=12 --set held_out={} "
                          "--set conclusive.response=1 ";
  const test::TemporaryFolder folder;
  const auto ran = run_commands(
      "rths new adapter demo\nrths new adapter pilot --role controller\n"
      "for name in demo pilot; do\n(cd $name && cmake -B build && cmake --build build)\ndone\n" +
          run +
          "--out machine --set uncompensated={} --set "
          "specimen.bouc_wen.characteristic_strength_N=0" +
          " --set specimen.bouc_wen.post_yield_stiffness_N_per_m=5e6" +
          " --set specimen.lead_heating.enabled=false" +
          " --set \"node.srmd={adapter='plugin', role='machine', "
          "library='$PWD/demo/build/demo.so'}\"\n" +
          run + "--out controller --set 'uncompensated={xpc={delay=0}}'" +
          " --set \"node.xpc={adapter='plugin', role='controller', "
          "library='$PWD/pilot/build/pilot.so'}\"\n" +
          "echo both are conclusive\n",
      folder.path());

  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_NE(ran.out.find("both are conclusive\n"), std::string::npos) << ran.out;
}

TEST(CheckServer, NeedsAnAddressWithAPort) {
  for (const char* address : {"localhost", "localhost:", "localhost:many", "localhost:99999"}) {
    const auto refused = test::run_rths({"check", "server", address});
    EXPECT_EQ(refused.exit_code, 2) << address;
    EXPECT_NE(refused.err.find("expected FILE or server HOST:PORT"), std::string::npos)
        << refused.err;
  }
}

TEST(NewAdapter, RefusesNamesThatAreNoFileAndNoIdentifier) {
  EXPECT_NE(test::run_rths({"new", "adapter", "my-machine"}).err.find("expected letters"),
            std::string::npos);
  const test::TemporaryFolder folder;
  const test::Finished again = test::Running{
      {"/bin/bash", "-c",
       "cd " + folder.path().string() + " && mkdir demo && " + test::rths_command() +
           " new adapter demo"}}.wait();
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("demo: exists, expected a new folder"), std::string::npos) << again.err;
}

}  // namespace
}  // namespace rths::plugin

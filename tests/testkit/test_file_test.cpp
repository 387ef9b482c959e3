// SPDX-License-Identifier: Apache-2.0
//
// `rths test FILE`.
#include <cstdlib>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::testkit {
namespace {

class TestFile : public ::testing::Test {
 protected:
  test::Finished run(const std::string& text) {
    const std::string spring = (test::build_tree() / "bin/rths_test_spring").string();
    const std::string head =
        "format = 1\nname = \"of a file\"\ndeadline_s = 20\nmap = \"" +
        (test::source_tree() / "examples/python/two_signals.ringmap.toml").string() +
        "\"\n[[program]]\nnode = \"machine\"\ncommand = [\"" + spring + "\", \"{ring}\"]\n" +
        "[[program]]\nnode = \"solver\"\ncommand = [\"" +
        (test::build_tree() / "bin/rths_test_pusher").string() + "\", \"{ring}\"]\n";
    return test::run_rths(
        {"test", folder_.write("of_a_file.toml", head + text).string(), "--keep", kept().string()});
  }
  [[nodiscard]] std::filesystem::path kept() const { return folder_.path() / "kept"; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(TestFile, PassesAndLeavesNothing) {
  const auto ran =
      run("[[expect]]\nsignal = \"machine.force\"\nvalue = 1e5\ntolerance = 10\nwithin_s = 5\n"
          "[[expect]]\nsignal = \"machine.force\"\nabove = 1.5e5\nnever_within_s = 0.2\n"
          "[[expect]]\nends = \"solver\"\nwithin_s = 10\n");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(ran.out.find("of a file: passed ("), 0U) << ran.out;
  EXPECT_FALSE(std::filesystem::exists(kept()));
}

TEST_F(TestFile, KeepsLogsAndRecordingOfAFailure) {
  const auto ran = run("[[expect]]\nsignal = \"machine.force\"\nvalue = 3e5\nwithin_s = 0.2\n");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_NE(ran.err.find("of a file: machine.force: expected 300000 N from 0 to 0.2 s, last value"),
            std::string::npos)
      << ran.err;
  ASSERT_TRUE(std::filesystem::exists(kept()));
  const auto folder = std::filesystem::directory_iterator { kept() } -> path();
  for (const char* file : {"machine.log", "solver.log", "run.h5"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

TEST_F(TestFile, HasFaults) {
  const auto ran =
      run("[[fault]]\nkind = \"drop\"\nsignal = \"machine.force\"\n"
          "[[expect]]\nsignal = \"machine.force\"\nabove = 1\nnever_within_s = 0.5\n");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  const auto flipped =
      run("[[fault]]\nkind = \"flip\"\nsignal = \"machine.force\"\nbit = 31\n"
          "[[expect]]\nsignal = \"machine.force\"\nbelow = -9e4\nwithin_s = 5\n");
  EXPECT_EQ(flipped.exit_code, 0) << flipped.err;
  const auto killed =
      run("[[fault]]\nkind = \"kill\"\nnode = \"machine\"\n"
          "[[expect]]\nends = \"solver\"\nwithin_s = 10\n");
  EXPECT_EQ(killed.exit_code, 0) << killed.err;
}

TEST_F(TestFile, NamesThePlaceOfAMistake) {
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"", "has no [[expect]]"},
      {"[[expect]]\nsignal = \"machine.force\"\nwithin_s = 1\n", "value, above, below"},
      {"[[baseline]]\nfile = \"b.h5\"\n", "has [[baseline]] without an experiment"},
      {"[[expect]]\nends = \"nobody\"\nwithin_s = 1\n", "there is no program 'nobody'"},
      {"[[expect]]\nends = \"solver\"\nwithin = 1\n", "within"},
      {"[[fault]]\nkind = \"burn\"\nnode = \"solver\"\n", "expected one of kill, freeze, drop"},
      {"[[fault]]\nkind = \"drop\"\nsignal = \"machine.forse\"\n", "machine.force"},
  };
  for (const auto& [text, expected] : mistakes) {
    const auto refused = run(text);
    EXPECT_EQ(refused.exit_code, 2) << text;
    EXPECT_NE(refused.err.find("of_a_file.toml"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(expected), std::string::npos) << refused.err;
  }
}

TEST_F(TestFile, EndsAtOnceWhenAProgramFails) {
  const auto ran =
      run("[[program]]\nname = \"model\"\ncommand = [\"sh\", \"-c\", \"echo no licence; exit 3\"]\n"
          "[[expect]]\nsignal = \"machine.force\"\nabove = 1e9\nwithin_s = 15\n");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_NE(ran.err.find("program 'model' ended with 3: no licence"), std::string::npos) << ran.err;
  EXPECT_LT(ran.host_seconds, 10);
}

/// Configures and runs a project that has this build as its package.
test::Finished run_project(const test::TemporaryFolder& folder, const std::string& tests) {
  folder.write("CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.25)\nproject(user LANGUAGES NONE)\n"
               "find_package(rths REQUIRED COMPONENTS test)\nenable_testing()\n" +
                   tests);
  const std::string build = test::build_tree().string(), here = folder.path().string();
  return test::Running{{"/bin/bash", "-c",
                        "cmake -G Ninja -DCMAKE_PREFIX_PATH=" + build + " -S " + here + " -B " +
                            here + "/build && ctest --test-dir " + here +
                            "/build --output-on-failure"}}
      .wait(100);
}

TEST(AddTest, RunsAnExperimentInVirtualTime) {
  const test::TemporaryFolder folder;
  const std::string experiment = "EXPERIMENT " +
                                 (test::source_tree() / "examples/srmd_lprb_2d.toml").string() +
                                 " SET duration_s=3 rest_s=0 motion.scale=0.5\n";
  const auto ran = run_project(
      folder, "rths_add_test(NAME moves " + experiment +
                  "EXPECT \"signal=srmd.long.displ.fbk above=1e-4 within_s=3\")\n"
                  "rths_add_test(NAME stays " +
                  experiment + "EXPECT \"signal=srmd.long.displ.fbk above=10 within_s=3\")\n");

  EXPECT_NE(ran.exit_code, 0);
  EXPECT_NE(ran.out.find("50% tests passed, 1 tests failed out of 2"), std::string::npos)
      << ran.out << ran.err;
  EXPECT_NE(ran.out.find("srmd.long.displ.fbk: expected above 10"), std::string::npos) << ran.out;
}

TEST(AddTest, HasABaseline) {
  const test::TemporaryFolder folder;
  const auto with = [&](const std::string& name, const std::string& scale,
                        const std::string& tolerance) {
    return "rths_add_test(NAME " + name + " EXPERIMENT " +
           (test::source_tree() / "examples/srmd_lprb_2d.toml").string() +
           " SET duration_s=2 rest_s=0 motion.scale=" + scale +
           "\nBASELINE \"file=" + (folder.path() / "baseline.h5").string() +
           " signals=srmd.*.fbk,opf.* " + tolerance + "\")\n";
  };
  const auto missing = run_project(folder, with("first", "0.5", ""));
  // As its message says.
  const auto copy = missing.out.find("cp ");
  ASSERT_NE(copy, std::string::npos) << missing.out;
  EXPECT_EQ(std::system(missing.out.substr(copy, missing.out.find('\n', copy) - copy).c_str()), 0);
  const auto ran = run_project(folder, with("same", "0.5", "") + with("near", "0.52", "abs=1e9") +
                                           with("other", "0.52", "rel=0.001"));

  EXPECT_NE(missing.exit_code, 0);
  EXPECT_NE(missing.out.find("baseline.h5: does not exist; if the recording of this test is right"),
            std::string::npos);
  EXPECT_NE(ran.out.find("1 tests failed out of 3"), std::string::npos) << ran.out << ran.err;
  EXPECT_NE(ran.out.find("signals are outside their tolerance"), std::string::npos) << ran.out;
}

TEST(AddTest, HasProgramsOfTheVendorsApi) {
  const test::TemporaryFolder folder;
  const std::string bin = (test::build_tree() / "bin/rths_test_").string();
  const auto ran = run_project(
      folder, "rths_add_test(NAME vendor MAP " +
                  (test::source_tree() / "examples/python/two_signals.ringmap.toml").string() +
                  "\nNODES \"machine: " + bin + "vendor_spring\" \"solver: " + bin +
                  "pusher {ring}\"\n"
                  "EXPECT \"signal=machine.force value=1e5 tolerance=10 within_s=10\")\n");

  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_NE(ran.out.find("100% tests passed"), std::string::npos) << ran.out;
}

}  // namespace
}  // namespace rths::testkit

// SPDX-License-Identifier: Apache-2.0
// Failures of OpenSees, of its script and of its settings in a run.
#include <signal.h>

#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "opensees_run.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

struct Fate {
  const char* name;
  const char* message;
};

TEST_F(OpenSeesRun, EndsInOrderWhateverBecomesOfOpenSees) {
  for (const Fate& fate :
       {Fate{"kill", "fated.py was killed by signal 9"},
        Fate{"freeze", "OpenSees has sent no message for 1 s"},
        Fate{"fail", "fated.py ended with 3: there is no more ground to shake"},
        Fate{"vanish", "element 'bearing': the client closed the connection without code 99"}}) {
    const auto finished = run(experiment({kIdeal, "tests/opensees/fated.py",
                                          fmt::format(R"("{}", "{}", "50")", port_, fate.name)}),
                              "virtual");
    EXPECT_EQ(finished.exit_code, 2) << fate.name;
    EXPECT_NE(finished.err.find(fate.message), std::string::npos) << finished.err;
    EXPECT_LT(finished.host_seconds, 10) << fate.name;
  }
}

TEST_F(OpenSeesRun, SaysThatAScriptCannotStart) {
  const auto finished = run(
      experiment({kIdeal, kPlant,
                  fmt::format(R"("there_is_no_such_record.csv", "--port", "{}")", port_), kBoth}),
      "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("isolated_plant.py ended with 1: FileNotFoundError"),
            std::string::npos)
      << finished.err;
}

// The test is complete with its report, but the numerical result, its second run, is missing.
TEST_F(OpenSeesRun, FailsIfTheScriptCannotRunASecondTime) {
  const auto script = folder_.write(
      "once.py", fmt::format("import pathlib, runpy, sys\n"
                             "mark = pathlib.Path(__file__).with_suffix('.mark')\n"
                             "if mark.exists():\n    sys.exit('there is one licence')\n"
                             "mark.touch()\n"
                             "runpy.run_path('{}', run_name='__main__')\n",
                             (test::source_tree() / "tests/opensees/fated.py").string()));

  const auto finished =
      run(experiment({kIdeal, script, fmt::format(R"("{}", "leave", "{}")", port_, steps())}),
          "virtual");

  EXPECT_EQ(finished.exit_code, 1) << finished.err;
  EXPECT_NE(finished.err.find("rths: no numerical result: "), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("there is one licence"), std::string::npos) << finished.err;
  EXPECT_TRUE(std::filesystem::exists(out() / "report.json"));
}

TEST_F(OpenSeesRun, SaysThatAnOlderControllerWaitsForItsFirstTarget) {
  const auto finished =
      run(experiment({"[node.xpc]\nadapter = \"echo\"\nhandshake = \"target_first\"\n"
                      "[node.recorder]\nadapter = \"recorder\"\n",
                      "tests/opensees/oscillator.py",
                      fmt::format(R"("{}", "tcp", "50", "NewmarkExplicit", "0.5")", port_)}),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("set handshake = \"target_first\" for them"), std::string::npos)
      << finished.err;
}

TEST_F(OpenSeesRun, RefusesControlPointsThatAreTooFew) {
  const auto finished =
      run(experiment({kIdeal, kPlant, plant_arguments(), kBoth, "srmd", "",
                      "control_points = { trial = [\"expControlPoint 1 1 disp 2 disp\"] }"}),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("trial control point 1 declares too few signals: '3 disp' "
                              "(opf.vert.displ.target) is the first of 33 missing signals"),
            std::string::npos)
      << finished.err;
}

TEST_F(OpenSeesRun, EndsTheTestWhereAControlPointsLimitIs) {
  std::string point = "expControlPoint 1";
  for (const char* type : {"disp", "vel", "accel", "force", "time"})
    for (int dof = 1; dof <= 7; ++dof)
      point += fmt::format(" {} {}{}", dof, type,
                           dof == 1 && std::string{type} == "disp" ? " -lim -2 2" : "");
  const auto finished =
      run(experiment({kIdeal, kPlant, plant_arguments(), kBoth, "srmd", "",
                      fmt::format("control_points = {{ trial = [\"{}\"] }}", point)}),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("'opf.long.displ.target' would be"), std::string::npos)
      << finished.err;
  const recording::Reader reader{out() / "run.h5"};
  for (const double target : reader.signal("opf.long.displ.target"))
    EXPECT_LE(std::abs(target), 2 * 0.0254);
}

// OpenSees does not detect a closed socket and would poll it indefinitely.
TEST_F(OpenSeesRun, LeavesAUsersOpenSeesAsleepIfItIsKilled) {
  const std::string file = experiment({kIdeal, "", ""});
  test::Running laboratory{
      {test::rths_command(), "run", file, "--clock", "virtual", "--out", out().string()}};
  // The keeper starts when the port is open.
  ASSERT_TRUE(test::comes_true([&] { return !test::children_of(laboratory.pid()).empty(); }));
  const auto keepers = test::children_of(laboratory.pid());
  ASSERT_EQ(keepers.size(), 1U);
  const auto moving = folder_.path() / "moving";
  test::Running opensees{{python_, (test::source_tree() / "tests/opensees/patient.py").string(),
                          std::to_string(port_), moving.string()}};
  ASSERT_TRUE(test::comes_true([&] { return std::filesystem::exists(moving); }));

  kill(laboratory.pid(), SIGKILL);
  ASSERT_TRUE(test::comes_true([&] { return !test::is_running(laboratory.pid()); }));

  // A polling OpenSees would use a whole processor.
  std::this_thread::sleep_for(std::chrono::milliseconds{200});
  const double before = test::processor_time_of(opensees.pid());
  std::this_thread::sleep_for(std::chrono::milliseconds{500});
  EXPECT_LT(test::processor_time_of(opensees.pid()) - before, 0.1);
  EXPECT_TRUE(test::is_running(keepers[0]));
  kill(opensees.pid(), SIGKILL);
  EXPECT_TRUE(test::comes_true([&] { return !test::is_running(keepers[0]); }));
}

TEST_F(OpenSeesRun, LeavesNothingBehindAfterAUsersOpenSees) {
  const std::string file = experiment({kIdeal, "", ""});
  test::Running laboratory{
      {test::rths_command(), "run", file, "--clock", "virtual", "--out", out().string()}};
  ASSERT_TRUE(test::comes_true([&] { return !test::children_of(laboratory.pid()).empty(); }));
  const int keeper = test::children_of(laboratory.pid())[0];
  test::Running opensees{{python_, (test::source_tree() / "tests/opensees/fated.py").string(),
                          std::to_string(port_), "leave", std::to_string(steps())}};
  EXPECT_EQ(opensees.wait().exit_code, 0);
  const auto finished = laboratory.wait();
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_FALSE(test::is_running(keeper));
}

}  // namespace
}  // namespace rths

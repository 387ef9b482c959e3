// SPDX-License-Identifier: Apache-2.0
// The real OpenSees, unmodified, as the solver of a run.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths {
namespace {

using Rows = std::vector<std::vector<double>>;

Rows read_rows(const std::filesystem::path& file) {
  Rows rows;
  std::ifstream in{file};
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells{line};
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

// Root mean square of the difference over that of the reference about its mean.
double nrmse(const Rows& ours, const Rows& reference, std::size_t column) {
  double mean = 0, difference = 0, size = 0;
  for (const auto& row : reference) mean += row[column] / static_cast<double>(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    difference += std::pow(ours.at(i)[column] - reference[i][column], 2);
    size += std::pow(reference[i][column] - mean, 2);
  }
  return std::sqrt(difference / size);
}

class OpenSeesRun : public test::WithOpenSees<> {
 protected:
  /// What an experiment of these tests has of its own.
  struct Parts {
    std::string partners;
    std::filesystem::path script;
    std::string arguments;
    std::string axes = R"(["long"])";
    std::string map = "srmd";
    std::string element = {};  ///< of its table; none: `axes` are its degrees of freedom
    std::string node = {};     ///< more of the node's table
  };
  // A bearing whose law every program solves exactly; a script of ours or of the tests.
  std::string experiment(const Parts& parts) {
    folder_.write(
        "bilinear.toml",
        "bearing = 1\ntitle = \"bilinear\"\n[bilinear]\n"
        "characteristic_strength_N = 1_010_000\npost_yield_stiffness_N_per_m = 4_238_000\n"
        "yield_displacement_m = 2.855e-3\n");
    const auto tree = test::source_tree();
    const std::string script =
        parts.script.empty()
            ? ""
            : fmt::format("python = \"{}\"\nscript = \"{}\"\narguments = [{}]\n", python_,
                          (tree / parts.script).string(), parts.arguments);
    const std::string element = parts.element.empty() ? "dofs = " + parts.axes : parts.element;
    return folder_
        .write("experiment.toml", fmt::format(R"(format = 1
name = "opensees_test"
map = "{}"
axes = {}
duration_s = 30
[motion]
file = "{}"
column_long = 2
column_lat = 1
scale = 1.4
[specimen]
model = "bilinear.toml"
{}
[node.opf]
adapter = "opensees"
{}answer_deadline_s = 1
{}
[[node.opf.element]]
name = "bearing"
port = {}
{}
)",
                                              parts.map, parts.map == "srmd" ? parts.axes : kBoth,
                                              (tree / "examples/records" / kRecord).string(),
                                              parts.partners, script, parts.node, port_, element))
        .string();
  }

  [[nodiscard]] test::Finished run(const std::string& experiment, const std::string& clock) const {
    return test::run_rths({"run", experiment, "--clock", clock, "--out", out().string()}, 60);
  }
  // The same script with OpenSees' own bearing.
  [[nodiscard]] Rows own_response(const std::string& bearing) const {
    const auto response = folder_.path() / "own.csv";
    test::Running running{{python_, (test::source_tree() / kPlant).string(),
                           (test::source_tree() / "examples/records" / kRecord).string(),
                           "--columns", "2", "1", "--unit", "13.72931", "--bearing", bearing,
                           "--response", response.string()}};
    EXPECT_EQ(running.wait(60).exit_code, 0);
    return read_rows(response);
  }
  [[nodiscard]] std::filesystem::path out() const { return folder_.path() / "out"; }
  [[nodiscard]] std::string plant_arguments() const {
    return fmt::format(R"("{{motion}}", "--port", "{}", "--response", "{}")", port_,
                       (folder_.path() / "ring.csv").string());
  }
  [[nodiscard]] Rows ring_response() const { return read_rows(folder_.path() / "ring.csv"); }

  static constexpr const char* kRecord = "petrolia_1992_riodell_freefield.csv";
  static constexpr const char* kPlant = "examples/opensees/isolated_plant.py";
  static constexpr const char* kMast = "tests/opensees/mast.py";
  static constexpr const char* kIdeal =
      "[node.xpc]\nadapter = \"ideal_machine\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kMachine =
      "[node.srmd]\nadapter = \"srmd\"\n[node.xpc]\nadapter = \"simulink_like\"\n"
      "diagram = \"hybrid_controller\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kBoth = R"(["long", "lat"])";
  test::TemporaryFolder folder_;
  std::uint16_t port_ = test::free_port();
};

TEST_F(OpenSeesRun, FeelsABearingOnTheRingAsItsOwn) {
  const auto finished = run(experiment({kIdeal, kPlant, plant_arguments(), kBoth}), "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const Rows ring = ring_response(), own = own_response("plasticity");
  ASSERT_EQ(own.size(), 3000U);
  ASSERT_EQ(ring.size(), own.size());
  // Displacements travel as float32: 7 digits.
  for (std::size_t column = 1; column <= 4; ++column)
    EXPECT_LT(nrmse(ring, own, column), 1e-4) << column;
}

TEST_F(OpenSeesRun, MovesTheMachineThroughTheController) {
  const auto finished = run(experiment({kMachine, kPlant, plant_arguments(), kBoth}), "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
  const Rows ring = ring_response(), own = own_response("plasticity");
  ASSERT_EQ(ring.size(), own.size());
  // What remains of the machine's lateness makes much of a bearing this stiff: with our own solver
  // the demo differs by as much.
  EXPECT_LT(nrmse(ring, own, 1), 0.5);
  EXPECT_LT(nrmse(ring, own, 2), 0.3);
}

// Rows at which a signal rises above 0, or falls back.
std::vector<std::size_t> edges(const std::vector<double>& signal, bool rising) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < signal.size(); ++i)
    if ((signal[i] > 0) != (signal[i - 1] > 0) && (signal[i] > 0) == rising) rows.push_back(i);
  return rows;
}

// A row is a tick of the controller.
TEST_F(OpenSeesRun, KeepsTheTimeOfTheController) {
  ASSERT_EQ(run(experiment({kMachine, kPlant, plant_arguments(), kBoth}), "virtual").exit_code, 0);
  const recording::Reader reader{out() / "run.h5"};
  const auto target = reader.signal("opf.newTarget"), taken = reader.signal("daq.switchPC"),
             there = reader.signal("daq.atTarget");
  for (const bool rising : {true, false}) {
    const auto asked = edges(target, rising), answered = edges(taken, rising);
    // The first targets fall between two rows.
    ASSERT_GE(asked.size(), 2990U);
    for (const std::size_t row : asked) {
      const auto answer = std::lower_bound(answered.begin(), answered.end(), row);
      ASSERT_NE(answer, answered.end());
      EXPECT_LE(*answer, row + 2);
    }
  }
  const auto arrived = edges(there, true);
  ASSERT_GE(arrived.size(), 2990U);
  for (std::size_t i = 2; i < arrived.size(); ++i)
    EXPECT_NEAR(static_cast<double>(arrived[i] - arrived[i - 1]), 10, 1) << i;
}

// OpenSees speaks when it likes; what is recorded does not tell.
TEST_F(OpenSeesRun, IsTheSameEveryTimeInVirtualTime) {
  const std::string file = experiment({kMachine, kPlant, plant_arguments(), kBoth});
  std::vector<std::vector<std::vector<double>>> recorded;
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(run(file, "virtual").exit_code, 0);
    const recording::Reader reader{out() / "run.h5"};
    recorded.emplace_back();
    for (const char* signal : {"opf.newTarget", "opf.long.displ.target", "daq.lat.force.fbk",
                               "srmd.long.force.fbk", "monitor.opf.step"})
      recorded.back().push_back(reader.signal(signal));
  }
  EXPECT_EQ(recorded[0], recorded[1]);
}

struct Fate {
  const char* name;
  const char* message;
};

TEST_F(OpenSeesRun, EndsInOrderWhateverBecomesOfOpenSees) {
  for (const Fate& fate :
       {Fate{"kill", "fated.py was killed by signal 9"},
        Fate{"freeze", "OpenSees has been silent for 1 s"},
        Fate{"fail", "fated.py ended with 3: there is no more ground to shake"},
        Fate{"vanish", "element 'bearing': the client is gone, without code 99"}}) {
    const auto finished = run(experiment({kIdeal, "tests/opensees/fated.py",
                                          fmt::format(R"("{}", "{}", "50")", port_, fate.name)}),
                              "virtual");
    EXPECT_EQ(finished.exit_code, 2) << fate.name;
    EXPECT_NE(finished.err.find(fate.message), std::string::npos) << finished.err;
    EXPECT_LT(finished.seconds, 10) << fate.name;
  }
}

TEST_F(OpenSeesRun, EndsWhenOpenSeesTakesLeave) {
  const auto finished = run(
      experiment({kIdeal, "tests/opensees/fated.py", fmt::format(R"("{}", "leave", "50")", port_)}),
      "virtual");
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const recording::Reader reader{out() / "run.h5"};
  EXPECT_EQ(reader.signal("monitor.opf.step").back(), 49);  // the ground is still at first
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

// Sheared, turned and loaded by its weight, with moments of the weight on the sheared bearing, and
// its coordinates not those of the script.
TEST_F(OpenSeesRun, FeelsSixComponentsOfABearingAsItsOwn) {
  const auto ring = folder_.path() / "ring.csv", own = folder_.path() / "own.csv";
  const std::string bearing = R"([node.opf.element.bearing]
height = 0.5
shear_distance = 0.3
{}
[node.opf.element.bearing.axes]
shear_y = "-long"
shear_z = "lat"
[node.opf.element.bearing.springs]
axial = 3e9
torsion = 2e7
rotation_y = 4e8
rotation_z = 5e8
)";
  const auto difference = [&](const char* option, const std::string& more) {
    const std::string arguments =
        fmt::format(R"("{{motion}}", "ring", "{}", "{}"{})", port_, ring.string(), option);
    const auto finished = run(experiment({kIdeal, kMast, arguments, kBoth, "srmd",
                                          fmt::format(fmt::runtime(bearing), more)}),
                              "virtual");
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    if (!std::filesystem::exists(own)) {
      test::Running running{{python_, (test::source_tree() / kMast).string(),
                             (out() / "run.opf.motion.csv").string(), "own", "0", own.string()}};
      EXPECT_EQ(running.wait(60).exit_code, 0);
    }
    const Rows found = read_rows(ring), expected = read_rows(own);
    EXPECT_EQ(found.size(), 1000U);
    double worst = 0;
    for (const std::size_t column : {1U, 2U, 4U, 5U})
      worst = std::max(worst, nrmse(found, expected, column));
    return worst;
  };
  EXPECT_LT(difference("", ""), 1e-5);
  EXPECT_LT(difference(R"(, "--both-nodes")", "i_dofs = [1, 2, 3, 4, 5, 6]"), 1e-5);
  // What the test would see.
  EXPECT_GT(difference("", "p_delta = false"), 0.01);
}

// Of every laboratory, with a controller of either generation.
TEST_F(OpenSeesRun, SpeaksToEveryLaboratory) {
  struct Facility {
    const char *map, *axis;
  };
  for (const auto& [map, axis] :
       {Facility{"srmd", "long"}, Facility{"sts", "8"}, Facility{"sts_gt", "1"},
        Facility{"mts469d_150", "1"}, Facility{"mts469d_gt", "yaw"}, Facility{"flextest_ucb", "1"},
        Facility{"flextest_osu", "2"}})
    for (const char* generation : {"at_target_first", "target_first"}) {
      const std::string handshake = fmt::format("handshake = \"{}\"\n", generation);
      const auto finished = run(
          experiment(
              {"[node.xpc]\nadapter = \"echo\"\nstiffness_N_per_m = 2.8\n" + handshake +
                   "[node.recorder]\nadapter = \"recorder\"\n",
               "tests/opensees/oscillator.py",
               fmt::format(R"("{}", "tcp", "50", "NewmarkExplicit", "0.5")", port_), R"(["long"])",
               map, fmt::format("dofs = [\"{}\"]\ninitial_stiffness = [[2.8]]", axis), handshake}),
          "virtual");
      ASSERT_EQ(finished.exit_code, 0) << map << ' ' << generation << finished.err;
      std::ifstream log{out() / "run.opf.log"};
      std::vector<double> u(3);
      for (double& value : u) log >> value;
      EXPECT_NEAR(u[1], -0.00994759549, 1e-8) << map;
      EXPECT_NEAR(u[2], -0.0388868053, 1e-8) << map;
    }
}

TEST_F(OpenSeesRun, SaysThatAnOlderControllerWaitsForItsFirstTarget) {
  const auto finished =
      run(experiment({"[node.xpc]\nadapter = \"echo\"\nhandshake = \"target_first\"\n"
                      "[node.recorder]\nadapter = \"recorder\"\n",
                      "tests/opensees/oscillator.py",
                      fmt::format(R"("{}", "tcp", "50", "NewmarkExplicit", "0.5")", port_)}),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("handshake = \"target_first\" goes with that"), std::string::npos)
      << finished.err;
}

TEST_F(OpenSeesRun, RefusesControlPointsThatAreTooFew) {
  const auto finished =
      run(experiment({kIdeal, kPlant, plant_arguments(), kBoth, "srmd", "",
                      "control_points = { trial = [\"expControlPoint 1 1 disp 2 disp\"] }"}),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("trial control point 1 declares too few signals: '3 disp' "
                              "(opf.vert.displ.target) is the first of 33 that are missing"),
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

// Behind the simulated machine, its friction, dead band and noise.
TEST_F(OpenSeesRun, IdentifiesTheSpecimenBeforeTheTest) {
  const auto finished =
      run(experiment({kMachine, kPlant, plant_arguments(), kBoth, "srmd",
                      "dofs = [\"long\", \"lat\"]\ninitial_stiffness = \"identified\""}),
          "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const recording::Reader reader{out() / "run.h5"};
  constexpr double kStiffness = 4.238e6 + 1.01e6 / 2.855e-3;  // [N/m]
  for (const char* axis : {"long", "lat"})
    EXPECT_NEAR(reader.signal(fmt::format("monitor.opf.bearing.{}.stiffness", axis)).back(),
                kStiffness, 0.05 * kStiffness)
        << axis;
  const Rows ring = ring_response();
  EXPECT_EQ(ring.size(), 3000U);
}

// Looks for up to ten seconds.
template <class Condition>
bool comes_true(const Condition& condition) {
  for (int look = 0; look < 1000 && !condition(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  return condition();
}

// A user's own OpenSees takes a closed socket for one on which there is no news yet.
TEST_F(OpenSeesRun, LeavesAUsersOpenSeesAsleepIfItIsKilled) {
  const std::string file = experiment({kIdeal, "", ""});
  test::Running laboratory{
      {test::rths_command(), "run", file, "--clock", "virtual", "--out", out().string()}};
  // It is there when the port is open.
  ASSERT_TRUE(comes_true([&] { return !test::children_of(laboratory.pid()).empty(); }));
  const auto keepers = test::children_of(laboratory.pid());
  ASSERT_EQ(keepers.size(), 1U);
  const auto moving = folder_.path() / "moving";
  test::Running opensees{{python_, (test::source_tree() / "tests/opensees/patient.py").string(),
                          std::to_string(port_), moving.string()}};
  ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(moving); }));

  kill(laboratory.pid(), SIGKILL);
  ASSERT_TRUE(comes_true([&] { return !test::is_running(laboratory.pid()); }));

  // Somebody who asks for ever would take all of it.
  std::this_thread::sleep_for(std::chrono::milliseconds{200});
  const double before = test::processor_time_of(opensees.pid());
  std::this_thread::sleep_for(std::chrono::milliseconds{500});
  EXPECT_LT(test::processor_time_of(opensees.pid()) - before, 0.1);
  EXPECT_TRUE(test::is_running(keepers[0]));
  kill(opensees.pid(), SIGKILL);
  EXPECT_TRUE(comes_true([&] { return !test::is_running(keepers[0]); }));
}

TEST_F(OpenSeesRun, LeavesNothingBehindAfterAUsersOpenSees) {
  const std::string file = experiment({kIdeal, "", ""});
  test::Running laboratory{
      {test::rths_command(), "run", file, "--clock", "virtual", "--out", out().string()}};
  ASSERT_TRUE(comes_true([&] { return !test::children_of(laboratory.pid()).empty(); }));
  const int keeper = test::children_of(laboratory.pid())[0];
  test::Running opensees{{python_, (test::source_tree() / "tests/opensees/fated.py").string(),
                          std::to_string(port_), "leave", "50"}};
  EXPECT_EQ(opensees.wait().exit_code, 0);
  const auto finished = laboratory.wait();
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_FALSE(test::is_running(keeper));
}

/// OpenSees at both ends of the ring: the frame and, as a model of its own, its column.
class OpenSeesSpecimen : public OpenSeesRun {
 protected:
  [[nodiscard]] std::vector<std::string> command(const std::string& column_arguments,
                                                 const std::string& protocol) const {
    const std::string units = "dofs=[\"long\"], length_unit_m=0.0254, force_unit_N=4448.2216";
    return {
        test::rths_command(),
        "run",
        (test::source_tree() / "examples/opensees/one_bay_frame.toml").string(),
        "--clock",
        "virtual",
        "--out",
        out().string(),
        "--set",
        fmt::format(
            "node.xpc={{adapter=\"opensees_specimen\", python=\"{}\", script=\"column.py\", "
            "arguments=[\"{}\"{}], connect_deadline_s=10, element=[{{name=\"column\", "
            "port={}, protocol=\"{}\", {}}}]}}",
            python_, column_port_, column_arguments, column_port_, protocol, units),
        "--set",
        fmt::format("node.opf={{adapter=\"opensees\", python=\"{}\", script=\"one_bay_frame.py\", "
                    "arguments=[\"{{motion}}\", \"--port\", \"{}\", \"--response\", \"{}\"], "
                    "element=[{{name=\"left_column\", port={}, initial_stiffness=[[2.8]], {}}}]}}",
                    python_, port_, (folder_.path() / "ring.csv").string(), port_, units)};
  }
  std::uint16_t column_port_ = test::free_port();
};

TEST_F(OpenSeesSpecimen, IsDrivenByASolverAsIfItWereOneModel) {
  const auto own = folder_.path() / "own.csv";
  for (const auto& [arguments, protocol] : std::vector<std::pair<std::string, std::string>>{
           {"", "tcp"}, {R"(, "--element", "actuator")", "tcp"}, {R"(, "--udp")", "udp"}}) {
    test::Running running{command(arguments, protocol)};
    const auto finished = running.wait(60);
    ASSERT_EQ(finished.exit_code, 0) << arguments << finished.err;
    if (!std::filesystem::exists(own)) {
      test::Running alone{{python_,
                           (test::source_tree() / "examples/opensees/one_bay_frame.py").string(),
                           (out() / "run.opf.motion.csv").string(), "--column", "steel",
                           "--response", own.string()}};
      ASSERT_EQ(alone.wait(60).exit_code, 0);
    }
    const Rows found = ring_response(), expected = read_rows(own);
    ASSERT_EQ(found.size(), 3000U);
    // Float32, and a ten-millionth that it stays behind.
    for (const std::size_t column : {1U, 2U}) EXPECT_LT(nrmse(found, expected, column), 1e-5);
  }
}

TEST_F(OpenSeesSpecimen, EndsTheRunWhenItDies) {
  test::Running laboratory{command("", "tcp")};
  int column = 0;
  ASSERT_TRUE(comes_true([&] {
    for (const int child : test::children_of(laboratory.pid()))
      if (test::command_line_of(child).find("column.py") != std::string::npos) column = child;
    return column != 0 && std::filesystem::exists(folder_.path() / "ring.csv");
  }));
  kill(column, SIGKILL);
  const auto finished = laboratory.wait(20);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("xpc: element 'column': OpenSees is gone"), std::string::npos)
      << finished.err;
  EXPECT_NE(finished.err.find("column.py was killed by signal 9"), std::string::npos)
      << finished.err;
}

TEST_F(OpenSeesSpecimen, SaysThatItsScriptCannotStart) {
  test::Running laboratory{command(R"(, "--element", "spring")", "tcp")};
  const auto finished = laboratory.wait(20);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("column.py ended with 2: column.py: error: argument --element"),
            std::string::npos)
      << finished.err;
}

struct Shipped {
  const char* integrator;
  double most;  ///< difference [-]
};

class OpenSeesIntegrator : public OpenSeesRun, public testing::WithParamInterface<Shipped> {};

// The frame that is shipped, its column once on the ring and once OpenSees' own.
TEST_P(OpenSeesIntegrator, FeelsAColumnOnTheRingAsItsOwn) {
  const auto examples = test::source_tree() / "examples/opensees";
  const auto ring = folder_.path() / "ring.csv", own = folder_.path() / "own.csv";
  const auto finished = test::run_rths(
      {"run", (examples / "one_bay_frame.toml").string(), "--clock", "virtual", "--out",
       out().string(), "--set",
       fmt::format("node.opf={{adapter=\"opensees\", python=\"{}\", script=\"one_bay_frame.py\", "
                   "arguments=[\"{{motion}}\", \"--port\", \"{}\", \"--response\", \"{}\", "
                   "\"--duration\", \"10\", \"--integrator\", \"{}\", \"0.8\"], "
                   "element=[{{name=\"left_column\", port={}, "
                   "dofs=[\"long\"], length_unit_m=0.0254, force_unit_N=4448.2216, "
                   "initial_stiffness=[[2.8]]}}]}}",
                   python_, port_, ring.string(), GetParam().integrator, port_)});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  test::Running alone{{python_, (examples / "one_bay_frame.py").string(),
                       (out() / "run.opf.motion.csv").string(), "--column", "steel", "--integrator",
                       GetParam().integrator, "0.8", "--duration", "10", "--response",
                       own.string()}};
  ASSERT_EQ(alone.wait(60).exit_code, 0);
  const Rows found = read_rows(ring), expected = read_rows(own);
  ASSERT_EQ(found.size(), 1000U);
  ASSERT_EQ(expected.size(), found.size());
  for (const std::size_t column : {1U, 2U})
    EXPECT_LT(nrmse(found, expected, column), GetParam().most) << column;
}

// Float32 on the ring; an integrator that iterates makes the specimen go where OpenSees' own
// element was only asked.
INSTANTIATE_TEST_SUITE_P(Of, OpenSeesIntegrator,
                         testing::Values(Shipped{"AlphaOS", 1e-5},
                                         Shipped{"AlphaOSGeneralized", 1e-5},
                                         Shipped{"KRAlphaExplicit", 1e-5},
                                         Shipped{"NewmarkExplicit", 1e-5},
                                         Shipped{"HHTHSFixedNumIter", 5e-3}),
                         [](const auto& shipped) { return std::string{shipped.param.integrator}; });

}  // namespace
}  // namespace rths

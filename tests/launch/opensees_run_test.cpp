// SPDX-License-Identifier: Apache-2.0
// The real OpenSees, unmodified, as the solver of a run.
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/opensees.hpp"
#include "support/process.hpp"

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

class OpenSeesRun : public testing::Test {
 protected:
  void SetUp() override {
    const auto python = test::opensees_python();
    if (!python)
      GTEST_SKIP()
          << "SKIPPED: there is no OpenSees here; ./lab test installs it in build/opensees";
    python_ = *python;
  }

  // A bearing whose law every program solves exactly; a script of ours or of the tests.
  std::string experiment(const std::string& partners, const std::filesystem::path& script,
                         const std::string& arguments, const std::string& axes = R"(["long"])") {
    folder_.write(
        "bilinear.toml",
        "bearing = 1\ntitle = \"bilinear\"\n[bilinear]\n"
        "characteristic_strength_N = 1_010_000\npost_yield_stiffness_N_per_m = 4_238_000\n"
        "yield_displacement_m = 2.855e-3\n");
    const auto tree = test::source_tree();
    return folder_
        .write("experiment.toml",
               fmt::format(R"(format = 1
name = "opensees_test"
map = "srmd"
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
python = "{}"
script = "{}"
arguments = [{}]
answer_deadline_s = 1
[[node.opf.element]]
name = "bearing"
port = {}
dofs = {}
)",
                           axes, (tree / "examples/records" / kRecord).string(), partners, python_,
                           (tree / script).string(), arguments, port_, axes))
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
  static constexpr const char* kIdeal =
      "[node.xpc]\nadapter = \"ideal_machine\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kMachine =
      "[node.srmd]\nadapter = \"srmd\"\n[node.xpc]\nadapter = \"simulink_like\"\n"
      "diagram = \"hybrid_controller\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kBoth = R"(["long", "lat"])";
  test::TemporaryFolder folder_;
  std::string python_;
  std::uint16_t port_ = test::free_port();
};

TEST_F(OpenSeesRun, FeelsABearingOnTheRingAsItsOwn) {
  const auto finished = run(experiment(kIdeal, kPlant, plant_arguments(), kBoth), "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const Rows ring = ring_response(), own = own_response("plasticity");
  ASSERT_EQ(own.size(), 3000U);
  ASSERT_EQ(ring.size(), own.size());
  // Displacements travel as float32: 7 digits.
  for (std::size_t column = 1; column <= 4; ++column)
    EXPECT_LT(nrmse(ring, own, column), 1e-4) << column;
}

TEST_F(OpenSeesRun, MovesTheMachineThroughTheController) {
  const auto finished = run(experiment(kMachine, kPlant, plant_arguments(), kBoth), "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
  const Rows ring = ring_response(), own = own_response("plasticity");
  ASSERT_EQ(ring.size(), own.size());
  // What remains of the machine's lateness makes much of a bearing this stiff: with our own solver
  // the demo differs by as much.
  EXPECT_LT(nrmse(ring, own, 1), 0.5);
  EXPECT_LT(nrmse(ring, own, 2), 0.3);
}

// OpenSees speaks when it likes; what is recorded does not tell.
TEST_F(OpenSeesRun, IsTheSameEveryTimeInVirtualTime) {
  const std::string file = experiment(kMachine, kPlant, plant_arguments(), kBoth);
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
    const auto finished = run(experiment(kIdeal, "tests/opensees/fated.py",
                                         fmt::format(R"("{}", "{}", "50")", port_, fate.name)),
                              "virtual");
    EXPECT_EQ(finished.exit_code, 2) << fate.name;
    EXPECT_NE(finished.err.find(fate.message), std::string::npos) << finished.err;
    EXPECT_LT(finished.seconds, 10) << fate.name;
  }
}

TEST_F(OpenSeesRun, EndsWhenOpenSeesTakesLeave) {
  const auto finished = run(
      experiment(kIdeal, "tests/opensees/fated.py", fmt::format(R"("{}", "leave", "50")", port_)),
      "virtual");
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const recording::Reader reader{out() / "run.h5"};
  EXPECT_EQ(reader.signal("monitor.opf.step").back(), 49);  // the ground is still at first
}

TEST_F(OpenSeesRun, SaysThatAScriptCannotStart) {
  const auto finished =
      run(experiment(kIdeal, kPlant,
                     fmt::format(R"("there_is_no_such_record.csv", "--port", "{}")", port_), kBoth),
          "virtual");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("isolated_plant.py ended with 1: FileNotFoundError"),
            std::string::npos)
      << finished.err;
}

}  // namespace
}  // namespace rths

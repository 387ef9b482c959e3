// SPDX-License-Identifier: Apache-2.0
// Accelerations of floors in an unmodified script of OpenSees.
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "opensees_run.hpp"
#include "support/json.hpp"
#include "support/opensees.hpp"

namespace rths {
namespace {

constexpr int kRoof = 207;  // at the end of the last slice

class OpenSeesFloors : public OpenSeesRun {
 protected:
  OpenSeesFloors() { duration_ = 2; }

  [[nodiscard]] std::string bricks(const std::string& floor, int processes = 1) const {
    const auto script = (test::source_tree() / "examples/opensees/brick_plant.py").string();
    const std::string arguments =
        fmt::format(R"("{}", "{{results}}.accelerations", "{}", {}, "--step", "0.01")", script,
                    kRoof, plant_arguments());
    return experiment(
        {kIdeal, "tests/opensees/recorded_bricks.py", arguments, kBoth, "srmd",
         fmt::format("dofs = {}\n[[node.opf.floor]]\nname = \"roof\"\n{}", kBoth, floor),
         fmt::format("processes = {}", processes)});
  }
  // Time, long and lat at each step, by OpenSees' own recorder.
  [[nodiscard]] Rows recorded_by_opensees() const {
    Rows rows;
    std::ifstream file{out() / "run.accelerations"};
    for (double time = 0, x = 0, y = 0; file >> time >> x >> y;) rows.push_back({time, x, y});
    return rows;
  }
};

TEST_F(OpenSeesFloors, AreRecordedAsByOpenSeesItself) {
  for (const int processes : {1, 2}) {
    if (processes > 1 && !test::has_mpich()) GTEST_SKIP() << test::kWithoutMpich;
    const auto finished = run(bricks(fmt::format("node = {}", kRoof), processes), "virtual");

    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const Rows expected = recorded_by_opensees();
    ASSERT_EQ(expected.size(), steps());
    const recording::Reader reader{out() / "run.h5"};
    const auto moves = reader.signal("monitor.opf.step");
    for (const std::size_t column : {1U, 2U}) {
      const auto found = recording::at_each_count(
          moves, reader.signal(column == 1 ? "monitor.opf.floor.1.accel.long"
                                           : "monitor.opf.floor.1.accel.lat"));
      double peak = 0, difference = 0;
      // The acceleration of a step is there when the next one moves.
      ASSERT_GE(found.size(), steps() - 1);
      const std::size_t late = found.size() - (steps() - 1);
      for (std::size_t i = 0; i + 1 < steps(); ++i) {
        peak = std::max(peak, std::abs(expected[i][column]));
        difference = std::max(difference, std::abs(found[i + late] - expected[i][column]));
      }
      EXPECT_GT(peak, 0.1) << column;
      EXPECT_LT(difference, 1e-6 * peak) << column << " with " << processes;  // float32
    }
  }
}

// With an ideal machine and a model that is the specimen, the test is its numerical result, which
// has one step more: the last of 200, at which no machine moves.
TEST_F(OpenSeesFloors, HaveSpectraInTheReport) {
  const auto finished = run(bricks(fmt::format("node = {}", kRoof)), "virtual");

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(finished.out.find("without floor spectra"), std::string::npos) << finished.out;
  const auto report = test::json_of(out() / "report.json");
  const auto& ratios = report["floors"]["roof"]["hybrid_over_numerical"];
  for (const char* band : {"below_6_Hz", "6_to_11_Hz", "above_11_Hz"})
    EXPECT_NEAR(ratios[band].get<double>(), 1, 0.03) << band;
}

TEST_F(OpenSeesFloors, AreRefusedIfTheScriptDoesNotHaveThem) {
  struct Case {
    const char *floor, *message;
  };
  for (const Case& one :
       {Case{"node = 9999", "there is no node 9999, which a floor names"},
        Case{"node = 207\ndofs = [1, 4]", "node 207 has 3 degrees of freedom, but a floor names 4"},
        Case{"node = 207\ndofs = [1]",
             "dofs of a floor are those along long and lat, expected two from 1 to 6; 0: none"}}) {
    const auto finished = run(bricks(one.floor), "virtual");

    EXPECT_EQ(finished.exit_code, 2) << one.floor;
    EXPECT_NE(finished.err.find(one.message), std::string::npos) << finished.err;
  }
}

TEST_F(OpenSeesFloors, NeedTheMotionOfTheExperiment) {
  const auto finished =
      run(experiment({kIdeal, "tests/opensees/fated.py",
                      fmt::format(R"("{}", "leave", "20")", port_), R"(["long"])", "srmd",
                      "dofs = [\"long\"]\n[[node.opf.floor]]\nname = \"roof\"\nnode = 1"}),
          "virtual");

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("ignores the motion of the experiment, expected {motion} among its "
                              "arguments"),
            std::string::npos)
      << finished.err;
}

}  // namespace
}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
#include <rths/session/plant.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/session/run.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

experiment::Experiment example(const char* name, const experiment::Overrides& changes = {}) {
  return app::load_experiment(test::source_tree() / "examples" / name, changes);
}

// The number after a text.
double number_after(const std::string& text, const std::string& before) {
  const auto at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before << " in " << text;
  return at == std::string::npos ? NAN : std::stod(text.substr(at + before.size()));
}

TEST(LargePlantOfATest, IsDescribed) {
  const std::string text = describe_plant(example("ant_486.toml"), 3);

  EXPECT_EQ(text.rfind("plant: 5676 degrees of freedom", 0), 0U) << text;
  // The mean load is the weight of the plant's mass over its bearings.
  EXPECT_NEAR(number_after(text, "mean "), 480e6 * 9.80665 / 486 / 1e6, 0.001);
  EXPECT_NEAR(number_after(text, "modes on yielded bearings: "), 0.329, 0.001);
}

TEST(LargePlantOfATest, IsCheckedAgainstAllDegreesOfFreedom) {
  const std::string text = check_plant(example("ant_486.toml"), 2),
                    coarse = check_plant(
                        example("ant_486.toml", {{"plant.frequency_limit_Hz", "10"}}), 2);

  const char* const tested = "displacement of the tested bearing ";
  EXPECT_LT(number_after(text, tested), 0.05);
  EXPECT_EQ(text.find("warning"), std::string::npos) << text;
  EXPECT_GT(number_after(coarse, tested), number_after(text, tested));
  EXPECT_NE(coarse.find("expected 46.2 Hz, 1.4 times"), std::string::npos) << coarse;
}

TEST(LargePlantOfATest, IsNoPlantOfSticks) {
  const auto error =
      test::error_of([] { static_cast<void>(describe_plant(example("srmd_lprb_2d.toml"), 3)); });

  EXPECT_NE(
      error.find("srmd_lprb_2d.toml: the plant is one of sticks, expected [plant] with model"),
      std::string::npos)
      << error;
}

struct Row {
  std::vector<double> values;
};

// Without the header.
std::vector<Row> rows_of(const std::string& table) {
  std::vector<Row> rows;
  std::istringstream text{table};
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream cells{line};
    Row row;
    for (std::string cell; std::getline(cells, cell, ',');) row.values.push_back(std::stod(cell));
    rows.push_back(std::move(row));
  }
  return rows;
}

class RecordedPlant : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& record, const experiment::Overrides& changes = {}) {
    RunSettings settings;
    settings.experiment = test::source_tree() / "examples/ant_486.toml";
    settings.changes = {{"duration_s", "1"}, {"rest_s", "0.5"}, {"plant.record", record}};
    settings.changes.insert(settings.changes.end(), changes.begin(), changes.end());
    settings.clock = launch::ClockKind::Virtual;
    settings.out = temporary_.path() / "run";
    settings.diagnoses = false;
    static_cast<void>(run(settings, {}));
    return settings.out / report::kRunFile;
  }

  const test::TemporaryFolder temporary_;
};

TEST_F(RecordedPlant, MovesItsTestedBearingAlongTheTargets) {
  const auto recording = made("[\"coordinates\", \"energy\"]");
  const recording::Reader run{recording};

  const auto tested = rows_of(motion_of_bearing(recording, 1));

  ASSERT_EQ(tested.size(), 1000U);
  EXPECT_DOUBLE_EQ(tested.back().values[0], 1);
  const auto times = run.signal("opf.1.time.target"), targets = run.signal("opf.long.displ.target");
  const auto at = static_cast<std::size_t>(
      std::find_if(times.begin(), times.end(), [](double time) { return time > 0.8995; }) -
      times.begin());
  ASSERT_NEAR(times[at], 0.9, 1e-4);
  // Words have 24 bits; the coordinates of the first modes are of the size of the target.
  EXPECT_NEAR(tested[899].values[1], targets[at], 1e-5 * std::abs(targets[at]));
  EXPECT_NE(targets[at], 0);
  const auto last = [&](const char* part) {
    return run.signal(std::string{"monitor.opf.energy."} + part).back();
  };
  const double input = last("input");
  EXPECT_GT(input, 0);
  EXPECT_NEAR(last("kinetic") + last("strain") + last("damped") + last("absorbed"), input,
              1e-3 * input);
}

TEST_F(RecordedPlant, HasADisplacementFieldThatMovesItsBearings) {
  const auto recording = made("[\"coordinates\"]");

  const auto bearing = rows_of(motion_of_bearing(recording, 486))[799].values;
  const auto field = rows_of(displacement_field(recording, 0.8));

  EXPECT_EQ(field.size(), 5676U / 3);
  // The last bearing is at the opposite corner, below the lowest node.
  const auto corner = std::max_element(field.begin(), field.end(), [](const Row& a, const Row& b) {
    const auto along = [](const Row& row) {
      return row.values[0] + row.values[1] - 10 * row.values[2];
    };
    return along(a) < along(b);
  });
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(corner->values[3 + k], bearing[1 + k], 1e-6 * std::abs(bearing[1 + k])) << k;
}

TEST_F(RecordedPlant, MustHaveBeenAskedForItsCoordinates) {
  const auto recording = made("[\"energy\"]");

  EXPECT_NE(test::error_of([&] { static_cast<void>(motion_of_bearing(recording, 1)); })
                .find("run.h5: has no coordinates of a plant, expected a test with record = "
                      "[\"coordinates\"] in [plant]"),
            std::string::npos);
}

// The bearing still moves along both axes; only one of them has targets.
TEST_F(RecordedPlant, MayBeTestedAlongOneAxis) {
  const auto recording = made("[\"coordinates\"]", {{"axes", "[\"lat\"]"}});

  EXPECT_EQ(rows_of(motion_of_bearing(recording, 1)).size(), 1000U);
}

TEST_F(RecordedPlant, HasNoOtherBearingOrTime) {
  const auto recording = made("[\"coordinates\"]");

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(motion_of_bearing(recording, 487));
            }).find("there is no bearing 487, expected 1 to 486"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(displacement_field(recording, 2));
            }).find("there is no target at 2 s, expected 0.001 to 1 s"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::session

// SPDX-License-Identifier: Apache-2.0
//
// The large plant as a test uses it: its kept modes, its analyses, and the plant on a fixed base.
#include <rths/plant/large_plant.hpp>

#include <fstream>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/plant/basis_file.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using test::lead_rubber;

Structure row_of_boxes() {
  Structure structure = assemble(test::boxes({.elements = 3}));
  return structure;
}

PlantDescription described(int* times_made = nullptr) {
  PlantDescription plant;
  plant.structure = [times_made] {
    if (times_made != nullptr) ++*times_made;
    return row_of_boxes();
  };
  plant.key = "three boxes";
  plant.floors = {"top"};
  plant.bearings = BearingSet::all_of(lead_rubber(), row_of_boxes().bearings.size());
  plant.frequency_limit = 20;
  return plant;
}

sim::GroundMotion constant_acceleration(double value) {
  sim::GroundMotion motion;
  motion.time_step = 0.01;
  motion.long_acceleration.assign(3000, value);
  motion.lat_acceleration.assign(3000, 0);
  return motion;
}

class KeptModes : public testing::Test {
 protected:
  rths::test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "modes.basis";
  Basis basis_ = LargePlant{described(), std::nullopt}.basis();
};

TEST_F(KeptModes, AreReadAsTheyWereWritten) {
  ASSERT_TRUE(write_basis(file_, "key", basis_));
  const auto read = read_basis(file_, "key");

  ASSERT_TRUE(read);
  EXPECT_EQ(read->stiffness, basis_.stiffness);
  EXPECT_EQ(read->bearings, basis_.bearings);
  EXPECT_EQ(read->floors, basis_.floors);
  EXPECT_EQ(read->participation, basis_.participation);
  EXPECT_EQ(read->weights, basis_.weights);
  EXPECT_EQ(read->frequencies, basis_.frequencies);
  EXPECT_EQ(read->mass, basis_.mass);
  EXPECT_EQ(read->dofs, basis_.dofs);
}

TEST_F(KeptModes, OfAnotherPlantAreNotUsed) {
  ASSERT_TRUE(write_basis(file_, "key", basis_));

  EXPECT_FALSE(read_basis(file_, "another key"));
  EXPECT_FALSE(read_basis(folder_.path() / "missing.basis", "key"));
}

TEST_F(KeptModes, AreNotUsedIfTheirFileIsDamagedOrCut) {
  ASSERT_TRUE(write_basis(file_, "key", basis_));
  const std::string whole = read_file(file_, kMostTextBytes);
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 40) {
    std::string damaged = whole;
    damaged[at] ^= 1;
    EXPECT_FALSE(read_basis(folder_.write("damaged", damaged), "key")) << at;
    EXPECT_FALSE(read_basis(folder_.write("cut", whole.substr(0, at)), "key")) << at;
  }
}

TEST_F(KeptModes, AreMadeOnce) {
  int made = 0;
  const LargePlant first{described(&made), folder_.path() / "cache"};
  const LargePlant second{described(&made), folder_.path() / "cache"};

  EXPECT_EQ(made, 1);
  EXPECT_EQ(second.basis().bearings, first.basis().bearings);
}

TEST_F(KeptModes, OnAFixedBaseAreMadeOnce) {
  int made = 0;
  const LargePlant plant{described(&made), folder_.path()};
  const sim::AnalysisSettings settings{constant_acceleration(1), 0, 0.01};
  for (int i = 0; i < 2; ++i) static_cast<void>(plant.analysis_on_fixed_base(settings));

  EXPECT_EQ(made, 2);  // with its bearings and without
}

TEST_F(KeptModes, AreMadeAgainForOtherBearings) {
  int made = 0;
  const LargePlant first{described(&made), folder_.path()};
  auto other = described(&made);
  other.bearings.kinds[0].terms[0].parameters[1].second *= 1.001;
  const LargePlant second{std::move(other), folder_.path()};

  EXPECT_EQ(made, 2);
}

TEST_F(KeptModes, AreMadeEachTimeWithoutAFolderToKeepThem) {
  int made = 0;
  const auto file = folder_.write("a file", "");
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ((LargePlant{described(&made), file / "below"}.basis().bearings), basis_.bearings);

  EXPECT_EQ(made, 2);
}

TEST(LargePlantModel, AnalysesItsReducedPlant) {
  const LargePlant plant{described(), std::nullopt};
  const BearingSet& bearings = plant.description().bearings;
  PlantSettings settings;
  settings.time_step = 0.005;
  const auto expected =
      make_reduced(plant.basis(), bearings, test::petrolia(), {{"top", 0}}, settings);

  const auto analysis = plant.analysis({test::petrolia(), 0, 0.005, settings.alpha});

  std::array<double, 3> target{}, rate{}, wanted{}, force{1e4, 2e4, 0};
  for (int step = 0; step < 100; ++step) {
    analysis->predict(target, rate);
    expected->predict(wanted, rate);
    EXPECT_EQ(target, wanted);
    analysis->correct(force);
    expected->correct(force);
  }
}

TEST(LargePlantModel, SaysItsSizeAndWeight) {
  const LargePlant plant{described(), std::nullopt};

  // Three boxes of 2 × 3 × 4 m and 2 t/m³ on a bearing at each of their 8 lower nodes.
  EXPECT_EQ(plant.summary().find("plant: 48 degrees of freedom in "), 0U) << plant.summary();
  EXPECT_NE(plant.summary().find(" 144 t on 8 bearings that carry "), std::string::npos);
}

TEST(LargePlantModel, RefusesWhatItDoesNotIntegrate) {
  const LargePlant plant{described(), std::nullopt};
  sim::AnalysisSettings settings{test::petrolia()};
  settings.substeps = 0;
  EXPECT_THROW(static_cast<void>(plant.analysis(settings)), Error);
}

// Under a constant acceleration of the ground, a damped structure comes to rest on it.
TEST(PlantOnAFixedBase, FollowsAConstantAccelerationOfTheGround) {
  auto description = described();
  description.damping_frequency = 100;
  description.damping_ratio = 0.5;
  const LargePlant plant{std::move(description), std::nullopt};
  const auto fixed = plant.analysis_on_fixed_base({constant_acceleration(1.5), 0, 1e-4, 0});
  std::array<double, 3> target{}, rate{}, force{};
  std::vector<double> values(fixed->monitors().size());
  const auto step = [&] {
    fixed->predict(target, rate);
    fixed->correct(force);
    fixed->monitor(values);
  };

  step();
  EXPECT_NEAR(values[0], 1.5, 1e-12);
  EXPECT_GT(std::abs(values[3] - 1.5), 0.1) << "a floor does not follow at once";
  for (int i = 0; i < 20'000; ++i) step();

  EXPECT_EQ(fixed->monitors()[3].name, "floor.1.accel.long");
  EXPECT_NEAR(values[3], 1.5, 1e-6);
  EXPECT_EQ(target[0], 0);
}

TEST(LargePlant, RefusesAStructureInOtherUnits) {
  const auto error_with = [](double mass_factor, double stiffness_factor) {
    PlantDescription plant = described();
    if (stiffness_factor < 1) plant.frequency_limit = 0.5;  // of few modes, so that there are more
    plant.structure = [=] {
      Structure structure = row_of_boxes();
      structure.mass *= mass_factor;
      structure.stiffness *= stiffness_factor;
      return structure;
    };
    return rths::test::error_of([&] { LargePlant{plant, std::nullopt}; });
  };

  EXPECT_EQ(error_with(1, 1), "");
  const std::string in_tonnes = error_with(1e-6, 1), in_other = error_with(1, 1e-3);
  EXPECT_NE(in_tonnes.find("are its masses in kg?"), std::string::npos) << in_tonnes;
  EXPECT_NE(in_other.find("is its stiffness in N/m?"), std::string::npos) << in_other;
}

}  // namespace
}  // namespace rths::plant

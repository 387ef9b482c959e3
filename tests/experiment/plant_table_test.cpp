// SPDX-License-Identifier: Apache-2.0
//
// The table of a large plant in an experiment: one line for each wrong value.
#include <algorithm>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/plant/large_plant.hpp>

#include "support/files.hpp"

namespace rths::experiment {
namespace {

std::string error_with(const Overrides& changes) {
  try {
    static_cast<void>(load_experiment(app::builtin_adapters(),
                                      test::source_tree() / "examples/ant_486.toml", changes));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(PlantTable, RefusesAWrongValueWithItsPlace) {
  const auto says = [](const Overrides& changes, const std::string& text) {
    EXPECT_NE(error_with(changes).find(text), std::string::npos) << error_with(changes);
  };
  says({{"plant.model", "stick"}}, "model is 'stick', expected sticks, ant or files");
  says({{"plant.tested_bearing", "middle"}},
       "tested_bearing is 'middle', expected corner, centre or a number from 1 to 486");
  says({{"plant.tested_bearing", "487"}}, "tested_bearing");
  says({{"plant.basis", "half"}}, "basis is 'half', expected reduced or full");
  says({{"plant.bearings", "7"}}, "plant: 7 bearings, expected 1, 5, 486");
  says({{"plant.bearings", "487"}}, "bearings");
  says({{"plant.bearings", "1"}},
       "tested_bearing is 'corner', expected centre or a number from 1 to 1");
  says({{"plant.bearings", "5"}, {"plant.tested_bearing", "6"}}, "tested_bearing");
  says({{"plant.dof", "12"}}, "dof");
  says({{"plant.model", "files"}}, "files");
  says({{"plant.model", "files"}, {"plant.files", "nowhere"}}, "nowhere");
}

TEST(PlantTable, RefusesWrongPlacesOfOtherBearings) {
  const auto says = [](const Overrides& changes, const std::string& text) {
    EXPECT_NE(error_with(changes).find(text), std::string::npos) << error_with(changes);
  };
  const auto slider = [](const std::string& places, const std::string& model = "eqsb") {
    return "{model = \"" + model + "\", places = " + places + "}";
  };
  says({{"plant.bearing.slider", slider("[487]")}},
       "there is no place 487, expected whole numbers from 1 to 486");
  says({{"plant.bearing.slider", slider("[2.5]")}}, "there is no place 2.5");
  says({{"plant.bearing.slider", slider("[0]")}}, "there is no place 0");
  says({{"plant.bearing.slider", slider("\"rim\"")}},
       "places is 'rim', expected edge, corners, inner or a list of numbers");
  says({{"plant.bearing.slider", slider("\"edge\"")}},
       "place 1 has 'slider', but its bearing is the tested one, expected the specimen there");
  says({{"plant.bearing.first", slider("\"inner\"")}, {"plant.bearing.second", slider("[20]")}},
       "place 20 has 'first' and 'second', expected one kind");
  says({{"plant.bearing.slider", slider("\"inner\"", "none")}}, "none");
  says({{"plant.bearing.slider", "{model = \"eqsb\"}"}}, "places");
  says({{"plant.bearing.slider", "{model = \"eqsb\", places = [2], stifness = 1}"}}, "stifness");
}

std::size_t kinds_at(const Overrides& changes, std::size_t kind) {
  const Experiment experiment = load_experiment(
      app::builtin_adapters(), test::source_tree() / "examples/ant_486.toml", changes);
  const auto& plant = dynamic_cast<const plant::LargePlant&>(*experiment.plant.structure);
  const auto& kind_of = plant.description().bearings.kind_of;
  return static_cast<std::size_t>(std::count(kind_of.begin(), kind_of.end(), kind));
}

TEST(PlantTable, PutsOtherBearingsAtTheirPlaces) {
  const auto count = [](const std::string& places, const Overrides& more) {
    Overrides changes = more;
    changes.push_back({"plant.bearing.slider", "{model = \"eqsb\", places = " + places + "}"});
    return kinds_at(changes, 1);
  };
  const Overrides centre{{"plant.tested_bearing", "centre"}, {"plant.frequency_limit_Hz", "5"}};

  EXPECT_EQ(count("\"corners\"", centre), 4U);
  EXPECT_EQ(count("\"edge\"", centre), 2U * (27 + 18) - 4);
  EXPECT_EQ(count("[2, 3, 486]", centre), 3U);
  EXPECT_EQ(count("\"inner\"", {{"plant.frequency_limit_Hz", "5"}}), 25U * 16);
  EXPECT_EQ(count("\"inner\"", {{"plant.bearings", "5"}}), 1U);
}

}  // namespace
}  // namespace rths::experiment

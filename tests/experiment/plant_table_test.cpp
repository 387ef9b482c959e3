// SPDX-License-Identifier: Apache-2.0
//
// The table of a large plant in an experiment: one line for each wrong value.
#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>

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

}  // namespace
}  // namespace rths::experiment

// SPDX-License-Identifier: Apache-2.0
// Commands and measurements of elements on the ring, and the effect of control points.
#include "opf_words.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

using Eigen::VectorXd;

// Two axes with three quantities each, and a time.
OpfLayout layout() {
  OpfLayout layout;
  for (const auto& [name, quantity, unit] : {std::tuple{"displ", OpfQuantity::Displacement, "m"},
                                             std::tuple{"veloc", OpfQuantity::Velocity, "m/s"},
                                             std::tuple{"force", OpfQuantity::Force, "N"}})
    for (const char* axis : {"long", "vert"})
      layout.commands.push_back(
          {std::string{"opf."} + axis + "." + name, axis, quantity, unit, 0.0254});
  layout.commands.push_back({"opf.1.time", "1", OpfQuantity::Time, "s"});
  for (const auto& [name, quantity, unit] : {std::tuple{"displ", OpfQuantity::Displacement, "m"},
                                             std::tuple{"force", OpfQuantity::Force, "N"}})
    for (const char* axis : {"long", "vert"})
      layout.feedbacks.push_back(
          {std::string{"daq."} + axis + "." + name, axis, quantity, unit, 0.0254});
  return layout;
}

OpenSeesElement element_on(const std::string& axis) {
  OpenSeesElement element;
  element.name = "column";
  element.is_rotation = {false};
  element.axes = {{axis, 0}};
  return element;
}

Specimen::Command command(double displacement, double velocity, double load = 0) {
  return {VectorXd::Constant(1, displacement), VectorXd::Constant(1, velocity),
          VectorXd::Constant(1, velocity), load};
}

std::vector<std::string> names(const std::vector<Port>& ports) {
  std::vector<std::string> names;
  for (const auto& port : ports) names.push_back(port.name);
  return names;
}

constexpr const char* kTrial =
    "1 1 disp -relTrial -lim -4 4 2 disp -relCtrl 1 vel 2 vel 1 force 2 force 1 time";
constexpr const char* kOutput = "2 1 disp 2 disp 1 force -relDaq 2 force";

TEST(OpfWords, OmitWordsThatNoElementUses) {
  const OpfWords words{control_points(layout(), {}, {}), {element_on("long")}};
  EXPECT_EQ(names(words.commands()),
            (std::vector<std::string>{"opf.long.displ", "opf.long.veloc", "opf.1.time"}));
  EXPECT_EQ(names(words.feedbacks()),
            (std::vector<std::string>{"daq.long.displ", "daq.long.force"}));
}

TEST(OpfWords, WriteTheCommandAndTheTimeOfTheTrial) {
  OpfWords words{control_points(layout(), {}, {}), {element_on("long")}};
  std::vector<double> commands(3);
  words.write(0, command(0.1, 0.2), 7.5, commands);
  EXPECT_EQ(commands, (std::vector<double>{0.1, 0.2, 7.5}));
  const auto measured = words.measured(0, std::vector<double>{0.09, 5e3});
  EXPECT_EQ(measured.displacement[0], 0.09);
  EXPECT_EQ(measured.force[0], 5e3);
}

TEST(OpfWords, CountFromTheFirstTrialAndTheMeasurementAtTheStart) {
  OpfWords words{control_points(layout(), {kTrial}, {kOutput}), {element_on("long")}};
  ASSERT_EQ(words.commands().size(), 7U);
  std::vector<double> commands(7);
  // The machine's start: long at 3 mm, vert at -10 mm, 2 kN on its load cell.
  words.set_start(std::vector<double>{0.003, -0.010, 2e3, 0});
  words.write_unused(commands);
  EXPECT_EQ(commands[1], -0.010);  // no element moves it
  words.set_first_trial(0, command(0.05, 0));
  words.write(0, command(0.05, 0), 0, commands);
  EXPECT_DOUBLE_EQ(commands[0], 0);
  words.write(0, command(0.08, 0), 0, commands);
  EXPECT_DOUBLE_EQ(commands[0], 0.03);
  EXPECT_EQ(commands[1], -0.010);
  EXPECT_EQ(words.measured(0, std::vector<double>{0, 0, 2.5e3, 0}).force[0], 500);
}

TEST(OpfWords, RefuseACommandBeyondTheLimitsOfAControlPoint) {
  OpfWords words{control_points(layout(), {kTrial}, {kOutput}), {element_on("long")}};
  std::vector<double> commands(7);
  words.write(0, command(0.1, 0), 0, commands);
  try {
    words.write(0, command(0.11, 0), 0, commands);  // four inches are 0.1016 m
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string{error.what()},
              "'opf.long.displ' would be 0.11 m, the limits of its control point are -0.1016 to "
              "0.1016");
  }
  EXPECT_EQ(commands[0], 0.1);
}

TEST(OpfWords, RefuseACommandThatItsWordCannotHold) {
  auto limited = layout();
  limited.commands[0].lowest = -8e36;
  limited.commands[0].highest = 8e36;
  OpfWords words{control_points(limited, {}, {}), {element_on("long")}};
  std::vector<double> commands(3);
  for (const double value : {1e300, -1e37, std::nan("")})
    EXPECT_THROW(words.write(0, command(value, 0), 0, commands), Error) << value;
  EXPECT_EQ(commands[0], 0);
}

TEST(OpfWords, MeasureTheFirstMoveFromTheStartPosition) {
  OpfWords words{control_points(layout(), {}, {}), {element_on("long")}};
  words.set_start(std::vector<double>{0.3, 0});
  EXPECT_NO_THROW(words.require_near_start(0, command(0.33, 0), 0.05));
  EXPECT_TRUE(words.is_away(0, command(0.33, 0), 0.02));
  EXPECT_FALSE(words.is_away(0, command(0.31, 0), 0.02));
  EXPECT_THROW(words.require_near_start(0, command(0, 0), 0.05), Error);
}

TEST(OpfWords, ApplyTheAxialLoadInTheAxisDirection) {
  auto element = element_on("long");
  element.is_rotation = {false, false};
  element.bearing.emplace();
  element.bearing->j_dofs = {1, 3};
  element.axes[0].index = kShearY;
  element.bearing->axial_load = MovedAxis{"vert", kAxial, -1};
  OpfWords words{control_points(layout(), {}, {}), {element}};
  EXPECT_EQ(names(words.commands()), (std::vector<std::string>{"opf.long.displ", "opf.long.veloc",
                                                               "opf.vert.force", "opf.1.time"}));
  std::vector<double> commands(4);
  words.write(0, command(0.1, 0, -8e6), 0, commands);
  EXPECT_EQ(commands[2], 8e6);
}

TEST(OpfWords, RefuseAnAxisOfAnotherKind) {
  auto element = element_on("long");
  element.is_rotation = {true};
  EXPECT_THROW(OpfWords(control_points(layout(), {}, {}), {element}), Error);
}

}  // namespace
}  // namespace rths::adapters

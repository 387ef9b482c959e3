// SPDX-License-Identifier: Apache-2.0
// OpenFresco's control points, checked against the blocks of all laboratories' maps.
#include <rths/adapters/control_points.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "support/files.hpp"

namespace rths::adapters {
namespace {

OpfLayout layout_of(const std::string& map) {
  return opf_layout(
      memmap::load_map(test::source_tree() / "memmap/maps" / (map + ".ringmap.toml")));
}

// The order of a laboratory's declaration: all degrees of freedom of one type after another.
std::string line_of(int tag, int dofs, const std::vector<std::string>& types) {
  std::string line = fmt::format("expControlPoint {}", tag);
  for (const auto& type : types)
    for (int dof = 1; dof <= dofs; ++dof) line += fmt::format(" {} {}", dof, type);
  return line;
}

std::string control_points_error(const OpfLayout& layout, const std::vector<std::string>& trial,
                                 const std::vector<std::string>& output = {}) {
  try {
    static_cast<void>(control_points(layout, trial, output));
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(OpfLayout, KnowsWhatAWordHolds) {
  const OpfSignal target = layout_of("srmd").commands[0];
  EXPECT_EQ(target.unit, "m");
  EXPECT_NEAR(target.highest, 3.4028234663852886e38 * 0.0254, 1e30);
  EXPECT_EQ(target.lowest, -target.highest);
}

struct Facility {
  const char* map;
  int dofs;
  std::vector<std::string> commands, feedbacks;
};
const std::vector<std::string> kFive{"disp", "vel", "accel", "force", "time"};
const Facility kFacilities[] = {{"srmd", 7, kFive, kFive},
                                {"sts", 8, kFive, kFive},
                                {"sts_gt", 8, kFive, kFive},
                                {"mts469d_150", 1, kFive, kFive},
                                {"mts469d_gt", 6, kFive, kFive},
                                {"flextest_ucb", 1, {"disp"}, {"disp", "force"}},
                                {"flextest_osu", 2, {"disp"}, {"disp", "force"}}};

class EachFacility : public testing::TestWithParam<Facility> {};

TEST_P(EachFacility, AcceptsAllSignalsOfItsBlock) {
  const auto& [map, dofs, commands, feedbacks] = GetParam();
  const auto points =
      control_points(layout_of(map), {line_of(1, dofs, commands)}, {line_of(2, dofs, feedbacks)});
  EXPECT_TRUE(points.is_declared);
  EXPECT_EQ(points.trial.size(), static_cast<std::size_t>(dofs) * commands.size());
  EXPECT_EQ(points.output.size(), static_cast<std::size_t>(dofs) * feedbacks.size());
  // The first and the last word that the controller reads and writes.
  EXPECT_EQ(points.trial.front().word.quantity, OpfQuantity::Displacement);
  EXPECT_EQ(points.output.back().word.quantity,
            feedbacks.size() == 2 ? OpfQuantity::Force : OpfQuantity::Time);
}

TEST_P(EachFacility, RefusesASignalTooFewOrTooMany) {
  const auto& [map, dofs, commands, feedbacks] = GetParam();
  const OpfLayout layout = layout_of(map);
  const std::string whole = line_of(1, dofs, commands);
  EXPECT_NE(control_points_error(layout, {whole + " 1 time"})
                .find("trial control point 1 declares too many"),
            std::string::npos);
  const std::string outputs = line_of(7, dofs, feedbacks);
  const std::string shortened = outputs.substr(0, outputs.rfind(' ', outputs.rfind(' ') - 1));
  EXPECT_NE(control_points_error(layout, {whole}, {shortened})
                .find("output control point 7 declares too few"),
            std::string::npos)
      << control_points_error(layout, {whole}, {shortened});
}

INSTANTIATE_TEST_SUITE_P(Maps, EachFacility, testing::ValuesIn(kFacilities),
                         [](const auto& facility) { return std::string{facility.param.map}; });

TEST(ControlPoints, SayWhichOneDeclaresTooFew) {
  const OpfLayout layout = layout_of("flextest_osu");
  EXPECT_EQ(control_points_error(layout, {"expControlPoint 1 1 disp"}),
            "trial control point 1 declares too few signals: '2 disp' (opf.2.displ.target) is the "
            "first of 1 missing signals; the map has 2 words there, 'opf.1.displ.target' to "
            "'opf.2.displ.target': all words after the difference would be misread");
  // The second begins with forces, so the first lacks a displacement.
  const std::string message = control_points_error(layout, {}, {"4 1 disp", "5 1 force 2 force"});
  EXPECT_NE(message.find("output control point 4 declares too few signals: '2 disp' "
                         "(daq.2.displ.fbk) is missing, control point 5 begins with '1 force'"),
            std::string::npos)
      << message;
}

TEST(ControlPoints, SayWhichSignalIsMisplaced) {
  const std::string message = control_points_error(layout_of("flextest_osu"), {"1 2 disp 1 disp"});
  EXPECT_NE(message.find("'2 disp' where '1 disp' (opf.1.displ.target) is expected"),
            std::string::npos)
      << message;
  // Sorted by quantity, not by axis.
  EXPECT_NE(
      control_points_error(layout_of("srmd"), {"1 1 disp 1 vel"}).find("'1 vel' where '2 disp'"),
      std::string::npos);
}

TEST(ControlPoints, ReadEverySpellingAndOption) {
  const auto points = control_points(layout_of("flextest_osu"),
                                     {"expControlPoint 1 -node 3 ux 1 -relOut -lim -100 200 "
                                      "-relTrial d2 dsp -relCtrl"},
                                     {"2 u1 disp u2 disp", "3 1 frc -relDaq 2 4"});
  EXPECT_DOUBLE_EQ(points.trial[0].lowest, -0.1);  // the map's millimetres
  EXPECT_DOUBLE_EQ(points.trial[0].highest, 0.2);
  EXPECT_TRUE(points.trial[0].is_relative_to_first);
  EXPECT_FALSE(points.trial[0].is_relative_to_measured);
  EXPECT_TRUE(points.trial[1].is_relative_to_measured);
  EXPECT_TRUE(points.output[2].is_relative_to_measured);
  EXPECT_EQ(points.output[3].word.name, "daq.2.force.fbk");
}

TEST(ControlPoints, RefuseUnknownWords) {
  const OpfLayout layout = layout_of("flextest_ucb");
  EXPECT_EQ(control_points_error(layout, {"1 1 strain"}),
            "control point '1 1 strain': found 'strain', expected disp, vel, accel, force or time");
  EXPECT_EQ(control_points_error(layout, {"1 zero disp"}),
            "control point '1 zero disp': found 'zero', expected a degree of freedom: 1, d1 or ux");
  EXPECT_NE(control_points_error(layout, {"1 1 disp -relIn"}).find("found '-relIn', expected -lim"),
            std::string::npos);
  EXPECT_NE(control_points_error(layout, {"1 1 disp -fact 25.4"})
                .find("found '-fact', expected no -fact"),
            std::string::npos);
  EXPECT_NE(control_points_error(layout, {"1 1 disp -lim nan nan"}).find("found 'nan'"),
            std::string::npos);
  EXPECT_NE(control_points_error(layout, {"1 1 disp -lim"})
                .find("found the end of the line, expected the lower limit"),
            std::string::npos);
  EXPECT_NE(control_points_error(layout, {"1 1 disp -lim 2 1"})
                .find("a lower limit above the upper limit"),
            std::string::npos);
  EXPECT_NE(control_points_error(layout, {"1"}).find("expected at least one signal"),
            std::string::npos);
}

TEST(OpfLayout, RefusesAMapWithoutTheBlock) {
  memmap::MapDescription description;
  description.name = "bare";
  description.size_longwords = 16;
  description.nodes = {{"xpc", NodeId{1}, ""}};
  EXPECT_THROW(static_cast<void>(opf_layout(memmap::Map{description})), Error);
}

}  // namespace
}  // namespace rths::adapters

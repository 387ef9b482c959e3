// SPDX-License-Identifier: Apache-2.0
// Element tables of a node, and the errors of wrong ones.
#include <gtest/gtest.h>

#include <rths/adapters/opensees.hpp>
#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr double kBearing = 3e8;  // [N/m]

OpenSeesElement element_of(const std::string& lines) {
  const Config table =
      Config::parse("[[element]]\nname = \"bearing\"\nport = 8090\n" + lines, "node.toml");
  OpenSeesSettings settings;
  read_opensees(table, kBearing, settings);
  return settings.elements.at(0);
}

std::string config_error(const std::string& lines) {
  try {
    static_cast<void>(element_of(lines));
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

const std::string kBearingLines =
    "[element.bearing]\nheight = 20\nshear_distance = 0.25\ni_dofs = [1, 2]\nj_dofs = [1, 2, 6]\n"
    "[element.bearing.axes]\nshear_y = \"-long\"\n"
    "[element.bearing.springs]\naxial = [[-1, -10], [0, 0], [2, 4]]\nshear_z = 0\ntorsion = 0\n"
    "rotation_y = 0\nrotation_z = 100\n[element.bearing.damping]\naxial = 3\n";

TEST(OpenSeesConfig, ReadsAnElementInTheScriptsCoordinates) {
  const auto element = element_of(
      "protocol = \"udp\"\ndofs = [\"long\", \"-yaw\"]\nlength_unit_m = 0.0254\nforce_unit_N = "
      "4448\n"
      "initial_stiffness = [[1, 2], [3, 4]]\ntrial = \"relative\"\n");
  EXPECT_TRUE(element.is_udp);
  EXPECT_TRUE(element.is_relative);
  EXPECT_FALSE(element.needs_identification());
  ASSERT_EQ(element.axes.size(), 2U);
  EXPECT_EQ(element.axes[1].axis, "yaw");
  EXPECT_EQ(element.axes[1].direction, -1);
  EXPECT_TRUE(element.is_rotation[1]);
  // kip/in, kip/rad, kip·in/in, kip·in/rad
  const double expected[] = {4448 / 0.0254, 2 * 4448, 3 * 4448, 4 * 4448 * 0.0254};
  ASSERT_EQ(element.initial_stiffness->values.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(element.initial_stiffness->values[i], expected[i], 1e-6) << i;
}

TEST(OpenSeesConfig, ReadsABearingInUnitsOfTheScript) {
  const auto element = element_of("length_unit_m = 0.01\nforce_unit_N = 1000\n" + kBearingLines);
  ASSERT_TRUE(element.bearing);
  EXPECT_EQ(element.is_rotation, (std::vector<bool>{false, false, false, false, true}));
  EXPECT_DOUBLE_EQ(element.bearing->height, 0.2);
  ASSERT_EQ(element.axes.size(), 1U);
  EXPECT_EQ(element.axes[0].index, static_cast<std::size_t>(kShearY));
  EXPECT_EQ(element.initial_stiffness->at(0, 0), kBearing);
  const auto& springs = element.bearing->springs;
  EXPECT_DOUBLE_EQ(springs[kAxial].elastic_force(0.01), 2000);  // a centimetre: 2 kN
  EXPECT_DOUBLE_EQ(springs[kAxial].damping, 3e5);
  EXPECT_DOUBLE_EQ(springs[kRotationZ].stiffness(), 100 * 1000 * 0.01);
}

TEST(OpenSeesConfig, ReadsActuatorsAndTheirComponents) {
  const auto element = element_of(
      "initial_stiffness = [[1]]\n[element.bearing]\nmoved = [\"shear_y\"]\n"
      "[element.bearing.springs]\naxial = 1\nshear_z = 0\ntorsion = 0\nrotation_y = 0\nrotation_z "
      "= 0\n"
      "[[element.bearing.actuator]]\naxis = \"3\"\nfixed_pin = [0, -2, 0]\nplaten_pin = [0, 1, "
      "0]\n");
  ASSERT_EQ(element.actuators.size(), 1U);
  EXPECT_EQ(element.actuators[0].axis, "3");
  EXPECT_EQ(element.actuators[0].fixed_pin[1], -2);
}

TEST(OpenSeesConfig, SaysWhatIsWrongAndWhere) {
  struct Wrong {
    std::string lines, message;
  };
  const std::string dofs = "dofs = [\"long\"]\n";
  const auto without = [](std::string lines, const std::string& line) {
    lines.erase(lines.find(line), line.size());
    return lines;
  };
  for (const auto& [lines, message] :
       {Wrong{"", "node.toml:1:1: 'dofs' is missing"},
        {"dofs = []\n", "an element has at least one degree of freedom"},
        {dofs + "protocol = \"tpc\"\n", "protocol is 'tpc', expected tcp or udp"},
        {dofs + "trial = \"total\"\n", "trial is 'total', expected absolute or relative"},
        {dofs + "initial_stiffness = [[1, 2]]\n",
         "initial_stiffness has 1 rows of 2, expected 1 of 1"},
        {dofs + "mass = \"guessed\"\n",
         "mass is 'guessed', expected rows of numbers or \"identified\""},
        {"dofs = [\"yaw\"]\n", "initial_stiffness is missing"},
        {"dofs = [\"vert\"]\n", "initial_stiffness is missing"},
        {kBearingLines + "[[element.bearing.actuator]]\naxis = \"1\"\nfixed_pin = [1, 0, 0]\n",
         "actuators need a list 'moved'"},
        {"[element.bearing]\naxial = \"force\"\nmoved = [\"axial\"]\n[element.bearing.axes]\naxial "
         "= "
         "\"vert\"\n",
         "axial is in 'moved', but axial = \"force\" loads it instead"},
        {dofs + "portt = 1\n", "portt"},
        {dofs + "address = \"localhost\"\n", "address is 'localhost', expected an IPv4 address"},
        {dofs + "peer = \"all\"\n", "peer is 'all', expected an IPv4 address or \"any\""},
        {dofs + "[[element]]\nname = \"other\"\nport = 8090\n" + dofs,
         "port 8090 is that of element 'bearing', expected another"},
        {without(kBearingLines, "torsion = 0\n"),
         "component 'torsion' is neither moved by the machine nor has a spring"},
        {without(kBearingLines, "shear_y = \"-long\"\n") + "", "component 'shear_y' is neither"},
        {kBearingLines + "shear_x = 1\n", "shear_x"},
        {"[element.bearing]\nmoved = [\"shear\"]\n",
         "there is no component 'shear', expected one of axial, shear_y, shear_z, torsion"},
        {"[element.bearing]\nj_dofs = [7]\n", "j_dofs holds 7, expected degrees of freedom 1 to 6"},
        {"[element.bearing]\nj_dofs = []\n", "neither node lists a degree of freedom"},
        {"[element.bearing]\ny_axis = [0, 0, 2]\n", "y_axis is parallel to x_axis"},
        {"[element.bearing]\naxial = \"stress\"\n",
         "axial is 'stress', expected deformation or force"},
        {"[element.bearing]\n[element.bearing.springs]\naxial = [[0, 0], [0, 1]]\n",
         "deformations do not increase: 0 follows 0"},
        {"[element.bearing]\n[element.bearing.springs]\naxial = [[0, 0]]\n",
         "one row, expected at least two"},
        {"[element.bearing]\nmoved = [\"axial\", \"shear_y\", \"shear_z\", \"torsion\", "
         "\"rotation_y\", "
         "\"rotation_z\"]\n[[element.bearing.actuator]]\naxis = \"1\"\nfixed_pin = [1, 0, 0]\n",
         "1 actuators cannot move 6 components"},
        {"[element.bearing]\nmoved = [\"axial\", \"shear_y\", \"shear_z\", \"torsion\", "
         "\"rotation_y\", "
         "\"rotation_z\"]\n[[element.bearing.actuator]]\naxis = \"1\"\n",
         "an actuator needs two pins at different positions"}})
    EXPECT_NE(config_error(lines).find(message), std::string::npos) << lines << "\n"
                                                                    << config_error(lines);
  EXPECT_NE(config_error(dofs).find("none"), std::string::npos) << config_error(dofs);
}

TEST(OpenSeesAdapterWords, SaysWhichAxisALaboratoryLacks) {
  OpenSeesSettings settings;
  settings.elements = {element_of("dofs = [\"long\"]\n")};
  settings.layout.commands = {{"opf.displ.target", "1", OpfQuantity::Displacement, "m"}};
  settings.layout.feedbacks = {{"daq.force.fbk", "1", OpfQuantity::Force, "N"}};
  const auto message = [&] {
    try {
      static_cast<void>(make_opensees(settings));
    } catch (const Error& error) {
      return std::string{error.what()};
    }
    return std::string{"none"};
  };
  EXPECT_EQ(message(),
            "element 'bearing': the map has no word for 'long disp', expected an axis of 1");
  settings.elements[0].axes[0].axis = "1";
  EXPECT_EQ(message(), "none");
  settings.elements.push_back(settings.elements[0]);
  EXPECT_EQ(message(),
            "element 'bearing': 'opf.displ.target' is already used by another axis or element");
}

}  // namespace
}  // namespace rths::adapters

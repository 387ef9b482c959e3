// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/text.hpp>

#include "eigen_conversion.hpp"

namespace rths::adapters {
namespace {

constexpr const char* kComponentNames[kComponents] = {"axial",   "shear_y",    "shear_z",
                                                      "torsion", "rotation_y", "rotation_z"};

template <class Names>
std::string listed(const Names& names) {
  return fmt::format("{}", fmt::join(std::begin(names), std::end(names), ", "));
}

// Whether a key has the first of two allowed words.
bool is_first_of(const Config& table, const char* key, const char* first, const char* second) {
  const std::string word = table.text(key, first);
  if (word != first && word != second)
    table.fail(key, fmt::format("{} is '{}', expected {} or {}", key, word, first, second));
  return word == first;
}

// "-vert": the machine's axis points the other way.
MovedAxis read_axis(const std::string& word, std::size_t index) {
  const bool is_reversed = word.starts_with('-');
  return {is_reversed ? word.substr(1) : word, index, is_reversed ? -1.0 : 1.0};
}

void read_generic(const Config& table, OpenSeesElement& element) {
  const auto names = table.texts("dofs");
  if (names.empty()) table.fail("dofs", "an element has at least one degree of freedom");
  for (std::size_t i = 0; i < names.size(); ++i) {
    element.axes.push_back(read_axis(names[i], i));
    const auto axis = axis_named(element.axes.back().axis);
    element.is_rotation.push_back(axis && kind_of(*axis) == AxisKind::Rotational);
  }
}

Vector3 read_vector(const Config& table, const char* key, const Vector3& otherwise) {
  const auto numbers = table.numbers(key, {otherwise[0], otherwise[1], otherwise[2]});
  if (numbers.size() != 3)
    table.fail(key, fmt::format("{} has {} numbers, expected 3", key, numbers.size()));
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<int> read_node_dofs(const Config& table, const char* key,
                                const std::vector<int>& otherwise) {
  if (!table.has(key)) return otherwise;
  std::vector<int> dofs;
  for (const double number : table.numbers(key)) {
    const int dof = static_cast<int>(number);
    if (dof != number || dof < 1 || dof > 6)
      table.fail(key, fmt::format("{} holds {}, expected degrees of freedom 1 to 6", key, number));
    dofs.push_back(dof);
  }
  return dofs;
}

void read_orientation(const Config& table, double length, BearingGeometry& bearing) {
  bearing.i_dofs = read_node_dofs(table, "i_dofs", bearing.i_dofs);
  bearing.j_dofs = read_node_dofs(table, "j_dofs", bearing.j_dofs);
  if (bearing.i_dofs.empty() && bearing.j_dofs.empty())
    table.fail("j_dofs", "neither node lists a degree of freedom");
  bearing.x_axis = read_vector(table, "x_axis", bearing.x_axis);
  bearing.y_axis = read_vector(table, "y_axis", bearing.y_axis);
  const Eigen::Vector3d x = to_eigen(bearing.x_axis), y = to_eigen(bearing.y_axis);
  if (!(x.cross(y).norm() > 1e-6 * x.norm() * y.norm()))
    table.fail("y_axis", "y_axis is parallel to x_axis, expected another direction");
  bearing.height = table.number_in("height", 0, 1e6, 0.0) * length;
  bearing.shear_distance = table.number_in("shear_distance", 0, 1, bearing.shear_distance);
  bearing.has_p_delta = table.flag("p_delta", bearing.has_p_delta);
}

// Reads a stiffness, or rows of deformation and force.
ComponentSpring read_spring(const Config& table, const char* key, double displacement,
                            double force) {
  ComponentSpring spring;
  if (!table.is_array(key)) {
    spring.points = {{0, 0}, {displacement, table.number_in(key, 0, 1e30) * force}};
    return spring;
  }
  for (const auto& row : table.rows(key)) {
    if (row.size() != 2)
      table.fail(key, fmt::format("a row of {} numbers, expected deformation, force", row.size()));
    spring.points.push_back({row[0] * displacement, row[1] * force});
    const std::size_t n = spring.points.size();
    if (n > 1 && !(spring.points[n - 1][0] > spring.points[n - 2][0]))
      table.fail(key, fmt::format("deformations do not increase: {:g} follows {:g}",
                                  spring.points[n - 1][0] / displacement,
                                  spring.points[n - 2][0] / displacement));
  }
  if (spring.points.size() < 2) table.fail(key, "one row, expected at least two");
  return spring;
}

Vector3 scaled(Vector3 vector, double factor) {
  for (double& value : vector) value *= factor;
  return vector;
}

void read_actuators(const Config& table, OpenSeesElement& element) {
  for (const auto& one : table.tables("actuator")) {
    const double length = element.length_unit;
    ActuatorAxis actuator{one.text("axis"), scaled(read_vector(one, "fixed_pin", {}), length),
                          scaled(read_vector(one, "platen_pin", {}), length)};
    if (!((to_eigen(actuator.fixed_pin) - to_eigen(actuator.platen_pin)).norm() > 0))
      one.fail("platen_pin", "an actuator needs two pins at different positions");
    one.reject_unknown_keys();
    element.actuators.push_back(actuator);
  }
  const auto& moved = element.axes;
  if (!element.actuators.empty() && table.texts("moved", {}).empty())
    table.fail("actuator", "actuators need a list 'moved' of the components that they move");
  if (!element.actuators.empty() && element.actuators.size() < moved.size())
    table.fail("actuator", fmt::format("{} actuators cannot move {} components",
                                       element.actuators.size(), moved.size()));
}

// Reads the components that actuators move.
std::vector<std::string> read_moved(const Config& table) {
  const auto moved = table.texts("moved", {});
  for (const auto& name : moved)
    if (std::find(std::begin(kComponentNames), std::end(kComponentNames), name) ==
        std::end(kComponentNames))
      table.fail("moved", fmt::format("there is no component '{}', expected one of {}", name,
                                      listed(kComponentNames)));
  return moved;
}

// Reads the spring of a component that the machine does not move.
ComponentSpring read_held(const Config& table, const Config& springs, const Config& damping,
                          std::size_t component, const OpenSeesElement& element) {
  const char* name = kComponentNames[component];
  const bool turns = component >= kTorsion;
  const double displacement = element.displacement_unit(turns);
  const double force = element.force_unit_of(turns);
  if (!springs.has(name))
    table.fail("springs", fmt::format("component '{}' is neither moved by the machine nor has a "
                                      "spring: state [….axes] {} or [….springs] {}",
                                      name, name, name));
  ComponentSpring spring = read_spring(springs, name, displacement, force);
  spring.damping = damping.number_in(name, 0, 1e30, 0.0) * force / displacement;
  return spring;
}

// A component is either moved or held by a spring. "moved" lists the components of actuators.
void read_components(const Config& table, OpenSeesElement& element) {
  BearingGeometry& bearing = *element.bearing;
  const Config axes = table.table_or_empty("axes"), springs = table.table_or_empty("springs"),
               damping = table.table_or_empty("damping");
  const auto moved = read_moved(table);
  const bool is_axial_moved = is_first_of(table, "axial", "deformation", "force");
  for (std::size_t i = 0; i < kComponents; ++i) {
    const char* name = kComponentNames[i];
    const bool is_loaded = i == kAxial && !is_axial_moved;
    const bool by_actuators = std::find(moved.begin(), moved.end(), name) != moved.end();
    if (is_loaded && by_actuators)
      table.fail("moved", "axial is in 'moved', but axial = \"force\" loads it instead");
    if (is_loaded) bearing.axial_load = read_axis(axes.text(name), i);
    if (!is_loaded && (axes.has(name) || by_actuators))
      element.axes.push_back(read_axis(by_actuators ? name : axes.text(name), i));
    else
      bearing.springs[i] = read_held(table, springs, damping, i, element);
  }
  axes.reject_unknown_keys();
  springs.reject_unknown_keys();
  damping.reject_unknown_keys();
}

void read_bearing(const Config& table, OpenSeesElement& element) {
  element.bearing.emplace();
  read_orientation(table, element.length_unit, *element.bearing);
  read_components(table, element);
  if (element.axes.empty()) table.fail("axes", "the machine moves no component of the bearing");
  read_actuators(table, element);
  for (const auto* dofs : {&element.bearing->i_dofs, &element.bearing->j_dofs})
    for (const int dof : *dofs) element.is_rotation.push_back(dof > 3);
  table.reject_unknown_keys();
}

// Reads the rows of a matrix of the moved components, in the units of the script.
SquareMatrix read_matrix(const Config& table, const char* key, const OpenSeesElement& element) {
  const std::size_t n = element.axes.size();
  const auto rows = table.rows(key);
  if (rows.size() != n || rows[0].size() != n)
    table.fail(key, fmt::format("{} has {} rows of {}, expected {} of {}", key, rows.size(),
                                rows.empty() ? 0 : rows[0].size(), n, n));
  auto matrix = SquareMatrix::diagonal(n, 0);
  for (std::size_t row = 0; row < n; ++row)
    for (std::size_t column = 0; column < n; ++column) {
      const double force = element.force_unit_of(element.turns(element.axes[row].index));
      const double displacement =
          element.displacement_unit(element.turns(element.axes[column].index));
      matrix.at(row, column) = rows[row][column] * force / displacement;
    }
  return matrix;
}

// The stiffness of the simulated bearing for each shear axis.
SquareMatrix stiffness_of_bearing(const Config& table, const OpenSeesElement& element,
                                  double of_bearing) {
  for (const auto& axis : element.axes)
    if (element.turns(axis.index) || (element.bearing && axis.index == kAxial) ||
        axis.axis == name_of(Axis::Vert) || axis.axis == "compression")
      table.fail(
          "initial_stiffness",
          "initial_stiffness is missing: the experiment's bearing defines it for shear only; "
          "state rows of numbers or \"identified\"");
  return SquareMatrix::diagonal(element.axes.size(), of_bearing);
}

std::optional<SquareMatrix> read_property(const Config& table, const char* key,
                                          const OpenSeesElement& element,
                                          const SquareMatrix& otherwise) {
  if (!table.has(key)) return otherwise;
  if (table.is_array(key)) return read_matrix(table, key, element);
  if (const std::string word = table.text(key); word != "identified")
    table.fail(key,
               fmt::format("{} is '{}', expected rows of numbers or \"identified\"", key, word));
  return std::nullopt;
}

void read_properties(const Config& table, double of_bearing, OpenSeesElement& element) {
  const auto zero = SquareMatrix::diagonal(element.axes.size(), 0);
  const bool is_stated = table.has("initial_stiffness");
  element.initial_stiffness =
      read_property(table, "initial_stiffness", element,
                    is_stated ? zero : stiffness_of_bearing(table, element, of_bearing));
  element.damping = read_property(table, "damping", element, zero);
  element.mass = read_property(table, "mass", element, zero);
  element.probe = table.number_in("probe_m", 1e-6, 0.1, element.probe);
}

bool is_address(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

// Reads an element's name, address and units.
OpenSeesElement read_connection(const Config& table) {
  OpenSeesElement element;
  element.name = table.text("name");
  const auto is_plain = [](char c) { return is_letter_or_digit(c) || c == '_'; };
  if (element.name.empty() || !std::all_of(element.name.begin(), element.name.end(), is_plain))
    table.fail("name", fmt::format("name is '{}', expected letters, digits and _", element.name));
  element.is_udp = !is_first_of(table, "protocol", "tcp", "udp");
  element.address = table.text("address", element.address);
  if (!is_address(element.address))
    table.fail("address", fmt::format("address is '{}', expected an IPv4 address such as 127.0.0.1",
                                      element.address));
  element.port = static_cast<std::uint16_t>(table.integer_in("port", 1, 65535));
  element.length_unit = table.number_in("length_unit_m", 1e-6, 1e3, 1.0);
  element.force_unit = table.number_in("force_unit_N", 1e-6, 1e9, 1.0);
  return element;
}

OpenSeesElement read_element(const Config& table, double initial_stiffness) {
  OpenSeesElement element = read_connection(table);
  element.peer = table.text("peer", "");
  if (table.has("peer") && element.peer != "any" && !is_address(element.peer))
    table.fail("peer",
               fmt::format("peer is '{}', expected an IPv4 address or \"any\"", element.peer));
  element.is_relative = !is_first_of(table, "trial", "absolute", "relative");
  element.first_trial = table.number_in("first_trial_m", 1e-6, 10, element.first_trial);
  if (table.has("bearing"))
    read_bearing(table.table("bearing"), element);
  else
    read_generic(table, element);
  read_properties(table, initial_stiffness, element);
  table.reject_unknown_keys();
  return element;
}

}  // namespace

std::vector<OpenSeesElement> read_specimen_elements(const Config& table) {
  std::vector<OpenSeesElement> elements;
  for (const auto& one : table.tables("element")) {
    elements.push_back(read_connection(one));
    read_generic(one, elements.back());
    one.reject_unknown_keys();
  }
  if (elements.empty())
    table.fail("element", "an opensees_specimen node needs at least one [[element]]");
  return elements;
}

void read_opensees(const Config& table, double initial_stiffness, OpenSeesSettings& settings) {
  for (const auto& one : table.tables("element")) {
    const OpenSeesElement element = read_element(one, initial_stiffness);
    for (const auto& other : settings.elements)
      if (other.port == element.port && other.is_udp == element.is_udp)
        one.fail("port", fmt::format("port {} is that of element '{}', expected another",
                                     element.port, other.name));
    settings.elements.push_back(element);
  }
  if (settings.elements.empty())
    table.fail("element", "an opensees node needs at least one [[element]]");
  const Config points = table.table_or_empty("control_points");
  settings.trial_points = points.texts("trial", {});
  settings.output_points = points.texts("output", {});
  points.reject_unknown_keys();
  settings.handshake = read_handshake(table);
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/adapters/opensees.hpp>
#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr const char* kRotations[] = {"roll", "pitch", "yaw"};

std::vector<OpenSeesDof> read_dofs(const Config& table) {
  const double length = table.number_in("length_unit_m", 1e-6, 1e3, 1.0);
  const double force = table.number_in("force_unit_N", 1e-6, 1e9, 1.0);
  std::vector<OpenSeesDof> dofs;
  for (const auto& name : table.texts("dofs")) {
    OpenSeesDof dof;
    dof.displacement = fmt::format("opf.{}.displ.target", name);
    dof.velocity = fmt::format("opf.{}.veloc.target", name);
    dof.is_rotation =
        std::find(std::begin(kRotations), std::end(kRotations), name) != std::end(kRotations);
    dof.force = fmt::format("daq.{}.{}.fbk", name, dof.is_rotation ? "moment" : "force");
    dof.displacement_unit = dof.is_rotation ? 1 : length;
    dof.force_unit = dof.is_rotation ? force * length : force;
    dofs.push_back(dof);
  }
  if (dofs.empty()) table.fail("dofs", "an element has at least one degree of freedom");
  return dofs;
}

// Rows, as they are written; zero if they are not.
MatrixXd read_matrix(const Config& table, const char* key, Index n) {
  MatrixXd matrix = MatrixXd::Zero(n, n);
  if (!table.has(key)) return matrix;
  const auto rows = table.rows(key);
  if (std::ssize(rows) != n || std::ssize(rows[0]) != n)
    table.fail(key, fmt::format("{} has {} rows of {}, expected {} of {}", key, rows.size(),
                                rows.empty() ? 0 : rows[0].size(), n, n));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      matrix(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return matrix;
}

// The bearing's, along each axis that it is sheared along.
MatrixXd stiffness_of(const std::vector<OpenSeesDof>& dofs, double of_bearing) {
  MatrixXd stiffness = MatrixXd::Zero(std::ssize(dofs), std::ssize(dofs));
  for (Index i = 0; i < stiffness.rows(); ++i) {
    const auto& dof = dofs[static_cast<std::size_t>(i)];
    stiffness(i, i) = of_bearing * dof.displacement_unit / dof.force_unit;
  }
  return stiffness;
}

OpenSeesElement read_element(const Config& table, double initial_stiffness) {
  OpenSeesElement element;
  element.name = table.text("name");
  const std::string protocol = table.text("protocol", "tcp");
  if (protocol != "tcp" && protocol != "udp")
    table.fail("protocol", fmt::format("protocol is '{}', expected tcp or udp", protocol));
  element.is_udp = protocol == "udp";
  element.address = table.text("address", element.address);
  element.port = static_cast<std::uint16_t>(table.integer_in("port", 1, 65535));
  element.dofs = read_dofs(table);
  const Index n = std::ssize(element.dofs);
  element.initial_stiffness = table.has("initial_stiffness")
                                  ? read_matrix(table, "initial_stiffness", n)
                                  : stiffness_of(element.dofs, initial_stiffness);
  element.damping = read_matrix(table, "damping", n);
  element.mass = read_matrix(table, "mass", n);
  table.reject_unknown_keys();
  return element;
}

}  // namespace

std::vector<OpenSeesElement> read_opensees_elements(const Config& table, double initial_stiffness) {
  std::vector<OpenSeesElement> elements;
  for (const auto& one : table.tables("element"))
    elements.push_back(read_element(one, initial_stiffness));
  if (elements.empty()) table.fail("element", "an opensees node needs at least one [[element]]");
  return elements;
}

}  // namespace rths::adapters

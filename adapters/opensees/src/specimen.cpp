// SPDX-License-Identifier: Apache-2.0
#include "specimen.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <rths/core/error.hpp>

#include "eigen_conversion.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kNodeDofs = 6, kLocalDofs = 12;
// Index within a node's six degrees of freedom.
enum NodeDof : Index { kX, kY, kZ, kAboutX, kAboutY, kAboutZ };
constexpr Index kNodeJ = kNodeDofs;

// Rows: the bearing's axes in the script's coordinates.
Eigen::Matrix3d rotation_of(const BearingGeometry& bearing) {
  const Eigen::Vector3d x = to_eigen(bearing.x_axis).normalized();
  const Eigen::Vector3d z = x.cross(to_eigen(bearing.y_axis)).normalized();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation;
}

// Maps the listed degrees of freedom to the local ones of both nodes.
MatrixXd local_displacements(const BearingGeometry& bearing) {
  const Eigen::Matrix3d rotation = rotation_of(bearing);
  MatrixXd global =
      MatrixXd::Zero(kLocalDofs, std::ssize(bearing.i_dofs) + std::ssize(bearing.j_dofs));
  Index column = 0;
  for (const int dof : bearing.i_dofs) global(dof - 1, column++) = 1;
  for (const int dof : bearing.j_dofs) global(kNodeJ + dof - 1, column++) = 1;
  MatrixXd local = MatrixXd::Zero(kLocalDofs, global.cols());
  for (Index block = 0; block < kLocalDofs; block += 3)
    local.middleRows(block, 3) = rotation * global.middleRows(block, 3);
  return local;
}

// Maps the local displacements of both nodes to the six components. Rotations of the nodes
// contribute to shear through their distance to the point of zero moment.
MatrixXd components(const BearingGeometry& bearing) {
  MatrixXd of = MatrixXd::Zero(kComponents, kLocalDofs);
  for (Index i = 0; i < kComponents; ++i) {
    of(i, i) = -1;
    of(i, kNodeJ + i) = 1;
  }
  const double below = bearing.shear_distance * bearing.height;
  const double above = bearing.height - below;
  of(kShearY, kAboutZ) = -below;
  of(kShearY, kNodeJ + kAboutZ) = -above;
  of(kShearZ, kAboutY) = below;
  of(kShearZ, kNodeJ + kAboutY) = above;
  return of;
}

}  // namespace

double ComponentSpring::elastic_force(double deformation) const {
  if (points.size() < 2) return 0;
  std::size_t next = 1;
  while (next + 1 < points.size() && points[next][0] < deformation) ++next;
  const auto &a = points[next - 1], &b = points[next];
  return a[1] + (b[1] - a[1]) / (b[0] - a[0]) * (deformation - a[0]);
}

double ComponentSpring::stiffness() const {
  // At a kink, the stiffer side: too stiff an estimate is stable.
  constexpr double kSmall = 1e-9;
  const double up = (elastic_force(kSmall) - elastic_force(0)) / kSmall;
  const double down = (elastic_force(0) - elastic_force(-kSmall)) / kSmall;
  return std::max(up, down);
}

ExperimentalElement::ExperimentalElement(const OpenSeesElement& element)
    : element_{element}, to_si_{element.dofs()}, to_script_{element.dofs()} {
  const Index n = element.dofs();
  for (Index i = 0; i < n; ++i) {
    const bool is_rotation = element.is_rotation[static_cast<std::size_t>(i)];
    to_si_[i] = element.displacement_unit(is_rotation);
    to_script_[i] = 1 / element.force_unit_of(is_rotation);
  }
  if (element.bearing) {
    local_ = local_displacements(*element.bearing);
    compatibility_ = components(*element.bearing) * local_;
  } else {
    compatibility_ = MatrixXd::Identity(n, n);
  }
  moved_.resize(std::ssize(element.axes), n);
  for (Index i = 0; i < moved_.rows(); ++i)
    moved_.row(i) =
        compatibility_.row(static_cast<Index>(element.axes[static_cast<std::size_t>(i)].index));
  springs_force_ = VectorXd::Zero(compatibility_.rows());
  local_displacement_ = VectorXd::Zero(kLocalDofs);
}

bool ExperimentalElement::is_moved(std::size_t component) const {
  return std::any_of(element_.axes.begin(), element_.axes.end(),
                     [&](const auto& axis) { return axis.index == component; });
}

const ExperimentalElement::Motion& ExperimentalElement::apply(const Trial& trial) {
  const VectorXd displacement = to_si_.cwiseProduct(trial.displacement);
  const VectorXd velocity = to_si_.cwiseProduct(trial.velocity);
  motion_.displacement = moved_ * displacement;
  motion_.velocity = moved_ * velocity;
  motion_.acceleration = moved_ * to_si_.cwiseProduct(trial.acceleration);
  if (!element_.bearing) return motion_;
  local_displacement_ = local_ * displacement;
  const VectorXd deformation = compatibility_ * displacement;
  const auto& springs = element_.bearing->springs;
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto row = static_cast<Index>(i);
    if (!is_moved(i)) springs_force_[row] = springs[i].elastic_force(deformation[row]);
  }
  axial_force_ =
      springs_force_[kAxial] + springs[kAxial].damping * compatibility_.row(kAxial).dot(velocity);
  return motion_;
}

// Moments of the axial force N for a lateral offset Δ and end rotations θ of the plates: N·Δ/2 at
// each end, and ± N/2·L·θ with the height L below or above the point of zero moment, of opposite
// sign at the two ends (`elastomericBearing` of OpenSees).
VectorXd ExperimentalElement::p_delta_moments(double axial_force) const {
  const BearingGeometry& bearing = *element_.bearing;
  const VectorXd& u = local_displacement_;
  const double below = bearing.shear_distance * bearing.height;
  const double above = bearing.height - below, half = axial_force / 2;
  VectorXd moments = VectorXd::Zero(kLocalDofs);
  const auto add = [&](Index about, double sway, double sign) {
    const double turned = below * u[about] - above * u[kNodeJ + about];
    moments[about] += sign * half * sway + half * turned;
    moments[kNodeJ + about] += sign * half * sway - half * turned;
  };
  add(kAboutZ, u[kNodeJ + kY] - u[kY], 1);
  add(kAboutY, u[kNodeJ + kZ] - u[kZ], -1);
  return moments;
}

VectorXd ExperimentalElement::resisting_forces(const VectorXd& moved) const {
  VectorXd forces = moved_.transpose() * moved;
  if (element_.bearing) {
    VectorXd components_force = springs_force_;
    for (std::size_t i = 0; i < element_.axes.size(); ++i)
      components_force[static_cast<Index>(element_.axes[i].index)] = moved[static_cast<Index>(i)];
    forces = compatibility_.transpose() * components_force;
    if (element_.bearing->has_p_delta)
      forces += local_.transpose() * p_delta_moments(components_force[kAxial]);
  }
  return to_script_.cwiseProduct(forces);
}

ElementMatrices ExperimentalElement::matrices(const MatrixXd& stiffness, const MatrixXd& damping,
                                              const MatrixXd& mass) const {
  MatrixXd k = moved_.transpose() * stiffness * moved_, c = moved_.transpose() * damping * moved_;
  for (std::size_t i = 0; element_.bearing && i < kComponents; ++i) {
    if (is_moved(i)) continue;
    const auto row = compatibility_.row(static_cast<Index>(i));
    k += element_.bearing->springs[i].stiffness() * row.transpose() * row;
    c += element_.bearing->springs[i].damping * row.transpose() * row;
  }
  const auto in_script = [&](const MatrixXd& matrix) -> MatrixXd {
    return to_script_.asDiagonal() * matrix * to_si_.asDiagonal();
  };
  return {in_script(k), in_script(c), in_script(moved_.transpose() * mass * moved_)};
}

Specimen::Specimen(const OpenSeesElement& element, double step)
    : element_{element}, coordinates_{element}, axes_{element} {
  const Index moved = std::ssize(element.axes), n = element.dofs();
  measured_damping_ = measured_mass_ = MatrixXd::Zero(n, n);
  stiffness_ = VectorXd::Zero(moved);
  const VectorXd zero = VectorXd::Zero(n);
  trial_ = {zero, zero, zero, 0};
  if (element.needs_identification())
    identification_.emplace(moved, VectorXd::Constant(moved, element.probe), step);
  else
    set_properties({to_eigen(*element.initial_stiffness), to_eigen(*element.damping),
                    to_eigen(*element.mass)});
}

void Specimen::set_properties(const SpecimenIdentification::Properties& identified) {
  const auto& stated = element_;
  const auto stated_or = [](const std::optional<SquareMatrix>& matrix, const MatrixXd& otherwise) {
    return matrix ? to_eigen(*matrix) : otherwise;
  };
  const MatrixXd stiffness = stated_or(stated.initial_stiffness, identified.stiffness);
  stiffness_ = stiffness.diagonal();
  matrices_ = coordinates_.matrices(stiffness, stated_or(stated.damping, identified.damping),
                                    stated_or(stated.mass, identified.mass));
  const MatrixXd zero = MatrixXd::Zero(stiffness.rows(), stiffness.rows());
  const auto measured = coordinates_.matrices(zero, stated.damping ? zero : identified.damping,
                                              stated.mass ? zero : identified.mass);
  const auto springs = coordinates_.matrices(zero, zero, zero);
  measured_damping_ = measured.damping - springs.damping;
  measured_mass_ = measured.mass;
}

const Specimen::Command& Specimen::command_of(const ExperimentalElement::Motion& motion) {
  command_.displacement = axes_.set_position(motion.displacement);
  command_.velocity = axes_.rate(motion.velocity);
  command_.acceleration = axes_.rate(motion.acceleration);
  return command_;
}

const Specimen::Command& Specimen::command_for(const Trial& trial) {
  trial_ = trial;
  const auto& motion = coordinates_.apply(trial);
  command_.load = coordinates_.axial_force();
  return command_of(motion);
}

Measurement Specimen::measured(const Measurement& axes) const {
  const VectorXd force = coordinates_.resisting_forces(axes_.force(axes.force)) -
                         measured_damping_ * trial_.velocity - measured_mass_ * trial_.acceleration;
  // A bearing's measurement covers only the moved components, not the position of its nodes.
  if (element_.bearing || axes.displacement.size() == 0) return {trial_.displacement, force};
  return {coordinates_.in_script(axes_.displacement(axes.displacement)), force};
}

const Specimen::Command& Specimen::probe() {
  const VectorXd displacement = identification_->target();
  const VectorXd rest = VectorXd::Zero(displacement.size());
  return command_of({displacement, rest, rest});
}

void Specimen::measure(const Measurement& axes) {
  identification_->measure(axes_.displacement(axes.displacement), axes_.force(axes.force));
  if (!identification_->is_done()) return;
  try {
    set_properties(identification_->properties());
  } catch (const Error& error) {
    throw Error{fmt::format("element '{}': {}", element_.name, error.what())};
  }
  identification_.reset();
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include "specimen.hpp"

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "eigen_conversion.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

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

// SPDX-License-Identifier: Apache-2.0
#include "specimen.hpp"

#include <fmt/format.h>

#include <rths/core/error.hpp>

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
  if (element.is_identified())
    identification_.emplace(moved, VectorXd::Constant(moved, element.probe), step);
  else
    settle({*element.initial_stiffness, *element.damping, *element.mass});
}

void Specimen::settle(const Identification::Found& found) {
  const auto& stated = element_;
  stiffness_ = stated.initial_stiffness.value_or(found.stiffness).diagonal();
  matrices_ = coordinates_.matrices(stated.initial_stiffness.value_or(found.stiffness),
                                    stated.damping.value_or(found.damping),
                                    stated.mass.value_or(found.mass));
  const MatrixXd nothing = MatrixXd::Zero(found.damping.rows(), found.damping.rows());
  const auto measured = coordinates_.matrices(nothing, stated.damping ? nothing : found.damping,
                                              stated.mass ? nothing : found.mass);
  const auto springs = coordinates_.matrices(nothing, nothing, nothing);
  measured_damping_ = measured.damping - springs.damping;
  measured_mass_ = measured.mass;
}

const Specimen::Command& Specimen::command_of(const ExperimentalElement::Motion& motion) {
  command_.displacement = axes_.place(motion.displacement);
  command_.velocity = axes_.rate(motion.velocity);
  command_.acceleration = axes_.rate(motion.acceleration);
  return command_;
}

const Specimen::Command& Specimen::place(const Trial& trial) {
  trial_ = trial;
  const auto& motion = coordinates_.place(trial);
  command_.load = coordinates_.axial_force();
  return command_of(motion);
}

Measured Specimen::measured(const Measured& axes) const {
  const VectorXd force = coordinates_.resisting(axes_.force(axes.force)) -
                         measured_damping_ * trial_.velocity - measured_mass_ * trial_.acceleration;
  // Of a bearing, only what is moved is measured, not the place of its nodes.
  if (element_.bearing || axes.displacement.size() == 0) return {trial_.displacement, force};
  return {coordinates_.in_script(axes_.displacement(axes.displacement)), force};
}

const Specimen::Command& Specimen::probe() {
  const VectorXd displacement = identification_->target();
  const VectorXd rest = VectorXd::Zero(displacement.size());
  return command_of({displacement, rest, rest});
}

void Specimen::measure(const Measured& axes) {
  identification_->measure(axes_.displacement(axes.displacement), axes_.force(axes.force));
  if (!identification_->is_done()) return;
  try {
    settle(identification_->found());
  } catch (const Error& error) {
    throw Error{fmt::format("element '{}': {}", element_.name, error.what())};
  }
  identification_.reset();
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#include "fixed_plant.hpp"

#include <numbers>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/sim/oscillator.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "floor_monitors.hpp"

namespace rths::plant {
namespace {

// Without the degrees of freedom that move the bearings.
Structure without_bearings(const Structure& structure) {
  std::vector<Index> kept(static_cast<std::size_t>(structure.dofs()), 0);
  const SparseMatrix B = structure.bearing_motion();
  for (Index dof = 0; dof < B.cols(); ++dof)
    if (SparseMatrix::InnerIterator{B, dof}) kept[static_cast<std::size_t>(dof)] = kNoDof;
  Index count = 0;
  for (Index& dof : kept)
    if (dof != kNoDof) dof = count++;
  const auto renumbered = [&](Index dof) {
    return dof < 0 ? kNoDof : kept[static_cast<std::size_t>(dof)];
  };
  Structure fixed;
  fixed.nodes = structure.nodes;
  fixed.floors = structure.floors;
  for (auto& node : fixed.nodes)
    for (Index& dof : node.dofs) dof = renumbered(dof);
  fixed.mass.resize(count);
  for (Index dof = 0; dof < structure.dofs(); ++dof)
    if (renumbered(dof) >= 0) fixed.mass[renumbered(dof)] = structure.mass[dof];
  std::vector<Eigen::Triplet<double>> entries;
  for (Index column = 0; column < structure.stiffness.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry{structure.stiffness, column}; entry; ++entry)
      if (renumbered(entry.row()) >= 0 && renumbered(entry.col()) >= 0)
        entries.emplace_back(renumbered(entry.row()), renumbered(entry.col()), entry.value());
  fixed.stiffness.resize(count, count);
  fixed.stiffness.setFromTriplets(entries.begin(), entries.end());
  return fixed;
}

class FixedPlant final : public sim::Substructure {
 public:
  FixedPlant(const Basis& basis, sim::GroundMotion motion, double time_step, double damping_time)
      : floors_{basis.floors},
        participation_{basis.participation},
        motion_{std::move(motion)},
        time_step_{time_step},
        modes_(static_cast<std::size_t>(basis.coordinates())),
        acceleration_{VectorXd::Zero(basis.coordinates())},
        floor_acceleration_{VectorXd::Zero(floors_.rows())} {
    for (Index i = 0; i < basis.coordinates(); ++i) {
      const double omega = std::sqrt(basis.stiffness[i]);
      if (!(damping_time * omega < 2))
        throw Error{
            fmt::format("plant: the mode at {:g} Hz is damped by {:.0f} %, expected less "
                        "than 100 %",
                        omega / (2 * std::numbers::pi), 50 * damping_time * omega)};
      steps_.push_back(sim::oscillator_step(omega, damping_time * omega / 2, time_step));
    }
  }

  [[nodiscard]] std::vector<sim::InterfaceDof> interface() const override {
    return sim::plant_interface();
  }
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override {
    ++count_;
    std::fill(target.begin(), target.end(), 0.0);
    std::fill(rate.begin(), rate.end(), 0.0);
  }
  void correct(std::span<const double> /*force*/) RTHS_REALTIME override {
    const Eigen::Vector3d now = ground_at(motion_, time());
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      const auto row = participation_.row(static_cast<Index>(i));
      const double before = row.dot(ground_), after = row.dot(now);
      // An oscillator tells its absolute acceleration: the modal load is not part of it.
      acceleration_[static_cast<Index>(i)] = modes_[i].advance(steps_[i], before, after) - after;
    }
    ground_ = now;
  }
  [[nodiscard]] double time() const RTHS_REALTIME override {
    return static_cast<double>(count_) * time_step_;
  }
  [[nodiscard]] std::vector<sim::MonitoredQuantity> monitors() const override {
    return monitors_of(static_cast<std::size_t>(floors_.rows()) / kDirections);
  }
  void monitor(std::span<double> values) const RTHS_REALTIME override {
    floor_acceleration_.noalias() = floors_ * acceleration_;
    write_monitors(ground_, floor_acceleration_, values);
  }

 private:
  MatrixXd floors_, participation_;
  sim::GroundMotion motion_;
  double time_step_;
  std::vector<sim::OscillatorStep> steps_;
  std::vector<sim::Oscillator> modes_;
  VectorXd acceleration_;  // of the modes, relative to the ground
  mutable VectorXd floor_acceleration_;
  Eigen::Vector3d ground_ = Eigen::Vector3d::Zero();
  std::size_t count_ = 0;
};

}  // namespace

Basis fixed_basis(const Structure& structure, double frequency_limit) {
  const Structure fixed = without_bearings(structure);
  Factor factor{fixed.stiffness};
  const StructureModes modes = modes_up_to(factor, fixed.mass, frequency_limit);
  Basis basis;
  basis.frequencies = modes.frequencies;
  basis.stiffness = (2 * std::numbers::pi * modes.frequencies).cwiseAbs2();
  basis.participation = modes.shapes.transpose() * fixed.inertia();
  basis.bearings = MatrixXd::Zero(0, modes.shapes.cols());
  basis.nodes = basis.bearing_places = MatrixXd::Zero(3, 0);
  basis.floors = MatrixXd::Zero(std::ssize(fixed.floors) * 3, modes.shapes.cols());
  Index row = 0;
  for (const auto& floor : fixed.floors)
    for (const Index dof : fixed.nodes[floor.node].dofs) {
      if (dof >= 0) basis.floors.row(row) = modes.shapes.row(dof);
      ++row;
    }
  for (std::size_t k = 0; k < kDirections; ++k) basis.mass[k] = fixed.mass_along(k);
  basis.dofs = fixed.dofs();
  return basis;
}

std::unique_ptr<sim::Substructure> make_fixed(const Basis& basis, const sim::GroundMotion& motion,
                                              double time_step, double damping_time) {
  return std::make_unique<FixedPlant>(basis, motion, time_step, damping_time);
}

}  // namespace rths::plant

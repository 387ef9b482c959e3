// SPDX-License-Identifier: Apache-2.0
#include "mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

constexpr const char* kInputs = "force.<mass>, base_acceleration or base_displacement";
constexpr const char* kOutputs =
    "displacement.<mass>, velocity.<mass>, acceleration.<mass>, deformation.<spring> or "
    "spring_force.<spring>";

std::optional<Mechanics::Output> output_called(const std::string& name) {
  using Output = Mechanics::Output;
  constexpr std::pair<const char*, Output> kKnown[] = {{"displacement", Output::Displacement},
                                                       {"velocity", Output::Velocity},
                                                       {"acceleration", Output::Acceleration},
                                                       {"deformation", Output::Deformation},
                                                       {"spring_force", Output::SpringForce}};
  for (const auto& [known, output] : kKnown)
    if (name == known) return output;
  return std::nullopt;
}

void read_inputs(const Config& table, Mechanics& mechanics, DynamicModel& model) {
  for (const auto& [role, words] : read_assignments(table)) {
    const std::size_t channel = model.inputs.size(), plant_input = model.plant_inputs.size();
    model.inputs.push_back(role);
    model.plant_inputs.push_back({channel, 0});
    if (words[0] == "force" && words.size() == 2) {
      const Index mass =
          read_index(table, role, words[1], static_cast<std::size_t>(mechanics.masses), "mass");
      mechanics.drives.push_back({Mechanics::Input::Force, mass, plant_input});
    } else if (words[0] == "base_acceleration" && words.size() == 1) {
      mechanics.drives.push_back({Mechanics::Input::BaseAcceleration, 0, plant_input});
    } else if (words[0] == "base_displacement" && words.size() == 1) {
      mechanics.drives.push_back({Mechanics::Input::BaseDisplacement, 0, plant_input});
      model.plant_inputs.push_back({channel, 1});
    } else {
      table.fail(role, fmt::format("'{}' is not an input, expected {}", table.text(role), kInputs));
    }
  }
}

void read_outputs(const Config& table, Mechanics& mechanics, DynamicModel& model) {
  for (const auto& [role, words] : read_assignments(table)) {
    const auto kind = output_called(words[0]);
    if (!kind || words.size() != 2)
      table.fail(role,
                 fmt::format("'{}' is not an output, expected {}", table.text(role), kOutputs));
    const bool of_spring =
        *kind == Mechanics::Output::Deformation || *kind == Mechanics::Output::SpringForce;
    const std::size_t most =
        of_spring ? mechanics.springs.size() : static_cast<std::size_t>(mechanics.masses);
    mechanics.readings.push_back(
        {*kind, read_index(table, role, words[1], most, of_spring ? "spring" : "mass")});
    model.outputs.push_back(role);
  }
}

// Share of the ground's displacement in the deformation of a spring.
double ground_share(const Spring& spring) {
  return (spring.to == 0 ? 1.0 : 0.0) - (spring.from == 0 ? 1.0 : 0.0);
}

void put_springs(const Mechanics& mechanics, const MatrixXd& inverse_mass, LinearSystem& system) {
  const Index n = mechanics.masses;
  for (Index i = 0; i < static_cast<Index>(mechanics.springs.size()); ++i) {
    const RowVectorXd row = mechanics.stretch(mechanics.springs[static_cast<std::size_t>(i)]);
    system.p.row(i).head(n) = row;
    system.r.row(i).tail(n) = row;
    system.e.col(i).tail(n) = -inverse_mass * row.transpose();
  }
}

// @returns acceleration of the coordinates' origin, by input
VectorXd put_inputs(const Mechanics& mechanics, const MatrixXd& inverse_mass,
                    LinearSystem& system) {
  const Index n = mechanics.masses, forces = static_cast<Index>(mechanics.springs.size());
  VectorXd base = VectorXd::Zero(system.b.cols());
  for (const auto& [kind, mass, plant_input] : mechanics.drives) {
    const auto input = static_cast<Index>(plant_input);
    if (kind == Mechanics::Input::Force) {
      system.b.col(input).tail(n) += inverse_mass.col(mass);
    } else if (kind == Mechanics::Input::BaseAcceleration) {
      system.b.col(input).tail(n) -= mechanics.influence;
      base[input] = 1;
    } else {
      for (Index i = 0; i < forces; ++i) {
        const double share = ground_share(mechanics.springs[static_cast<std::size_t>(i)]);
        system.q(i, input) = share;
        system.s(i, input + 1) = share;
      }
      // M⁻¹ K u and M⁻¹ C v of the structure that moves with the ground: also of couplings that no
      // connection lists.
      system.b.col(input).tail(n) -= system.a.bottomLeftCorner(n, n) * mechanics.influence;
      system.b.col(input + 1).tail(n) -= system.a.bottomRightCorner(n, n) * mechanics.influence;
    }
  }
  return base;
}

void put_outputs(const Mechanics& mechanics, const VectorXd& base, LinearSystem& system) {
  using Output = Mechanics::Output;
  const Index n = mechanics.masses;
  for (Index i = 0; i < system.c.rows(); ++i) {
    const auto& [kind, index] = mechanics.readings[static_cast<std::size_t>(i)];
    switch (kind) {
      case Output::Displacement:
        system.c(i, index) = 1;
        break;
      case Output::Velocity:
        system.c(i, n + index) = 1;
        break;
      case Output::Acceleration:
        system.c.row(i) = system.a.row(n + index);
        system.d.row(i) = system.b.row(n + index) + mechanics.influence[index] * base.transpose();
        system.h.row(i) = system.e.row(n + index);
        break;
      case Output::Deformation:
        system.c.row(i) = system.p.row(index);
        system.d.row(i) = system.q.row(index);
        break;
      case Output::SpringForce:
        system.c.row(i) = system.stiffness[index] * system.p.row(index) +
                          system.damping[index] * system.r.row(index);
        system.d.row(i) = system.stiffness[index] * system.q.row(index) +
                          system.damping[index] * system.s.row(index);
        system.h(i, index) = 1;
        break;
    }
  }
}

}  // namespace

void Mechanics::read(const Config& table, DynamicModel& model) {
  const Config inputs = table.table("inputs"), outputs = table.table("outputs");
  read_inputs(inputs, *this, model);
  read_outputs(outputs, *this, model);
  const auto uses = [&](Input kind) {
    return std::any_of(drives.begin(), drives.end(),
                       [&](const Drive& drive) { return drive.kind == kind; });
  };
  if (uses(Input::BaseAcceleration) && uses(Input::BaseDisplacement))
    throw Error{
        fmt::format("{}: the base is given by its acceleration and by its displacement, "
                    "expected only one of them",
                    inputs.where())};
  model.name = uses(Input::Force) ? "force to motion" : "base to structure";
}

RowVectorXd Mechanics::stretch(const Spring& spring) const {
  RowVectorXd row = RowVectorXd::Zero(masses);
  if (spring.to > 0) row[spring.to - 1] += 1;
  if (spring.from > 0) row[spring.from - 1] -= 1;
  return row;
}

void Mechanics::add_spring(const Spring& spring, DynamicModel& model) {
  springs.push_back(spring);
  const std::string title =
      spring.from == 0 || spring.to == 0
          ? fmt::format("between mass {} and the ground", spring.from + spring.to)
          : fmt::format("between masses {} and {}", spring.from, spring.to);
  const std::string component = fmt::format("spring.{}", springs.size());
  model.connections.push_back({component, title, component, {}, {}});
}

Spring Mechanics::read_spring(const Config& table) const {
  const auto ends = table.numbers("between");
  const auto is_end = [&](double end) {
    return end >= 0 && end <= static_cast<double>(masses) && end == std::floor(end);
  };
  if (ends.size() != 2 || !is_end(ends[0]) || !is_end(ends[1]) || ends[0] == ends[1])
    table.fail("between", fmt::format("between must be two different numbers from 0, the ground, "
                                      "to {}, the last mass",
                                      masses));
  return {static_cast<Index>(ends[0]), static_cast<Index>(ends[1])};
}

// States: displacements x, then velocities v.
LinearSystem Mechanics::system(const Matrices& matrices, std::size_t plant_inputs) const {
  const Index n = masses;
  LinearSystem system =
      LinearSystem::zeros(2 * n, static_cast<Index>(plant_inputs),
                          static_cast<Index>(readings.size()), static_cast<Index>(springs.size()));
  const MatrixXd inverse = maths::inverse(matrices.mass);
  system.a.topRightCorner(n, n).setIdentity();
  system.a.bottomLeftCorner(n, n) = -inverse * matrices.stiffness;
  system.a.bottomRightCorner(n, n) = -inverse * matrices.damping;
  system.stiffness = matrices.spring_stiffness;
  system.damping = matrices.spring_damping;
  put_springs(*this, inverse, system);
  const VectorXd base = put_inputs(*this, inverse, system);
  put_outputs(*this, base, system);
  return system;
}

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "dynamic_forms.hpp"

#include <numbers>

#include <fmt/format.h>

#include <rths/sim/tables.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kReach = 1.2;     // of the largest motion in the simulation as stated
constexpr double kMostForce = 10;  // of the connection's force
constexpr double kScale = 0.05;    // of the connection's force
constexpr double kCreep = 0.01;    // of the largest velocity
// In the travel from end to end: fewer periods may be any curve.
constexpr double kLeastPeriods = 3, kMostPeriods = 24, kPeriodStep = 0.5;

struct FormKind {
  const char* kind;
  const char* name;  // of the form
  bool over_velocity, is_viscosity;
};
constexpr FormKind kKinds[] = {{"tabulated_stiffness", "f(u)", false, false},
                               {"tabulated_damping", "f(v)", true, false},
                               {"tabulated_friction", "sgn(v) g(u)", false, false},
                               {"tabulated_viscosity", "v g(u)", false, true}};

FreeForm form_of(const FormKind& form, const Connection& connection, const ConnectionSize& size) {
  const sim::TermKind& kind = sim::term_kind(form.kind);
  Candidate candidate;
  candidate.name = fmt::format("{} {}", form.name, connection.title);
  candidate.kind = form.kind;
  candidate.channel = connection.seen;
  ModelTerm term{{form.kind, connection.component + "." + form.kind, {}}, connection.component};
  auto& stated = term.settings.parameters;
  const double range = kReach * (form.over_velocity ? size.velocity : size.displacement);
  stated.emplace_back("range", range);
  const double natural = form.is_viscosity ? size.force / size.velocity : size.force;
  for (const auto& parameter : kind.parameters) {
    if (parameter.name == "creep_velocity")
      stated.emplace_back("creep_velocity", kCreep * size.velocity);
    if (!parameter.name.starts_with("value_")) continue;
    candidate.frees.push_back({fmt::format("{}.{}", term.settings.name, parameter.name),
                               std::string{parameter.unit}, -kMostForce * natural,
                               kMostForce * natural, kScale * natural, false, 0.0});
  }
  candidate.starts = {VectorXd::Zero(static_cast<Index>(candidate.frees.size()))};
  candidate.price = static_cast<int>(candidate.frees.size());
  candidate.adds.push_back(std::move(term));
  FreeForm result{
      std::move(candidate), form.over_velocity ? "velocity [m/s]" : "displacement [m]", {}};
  for (const double knot : form.over_velocity ? sim::kDenseKnots : sim::kEvenKnots)
    result.knots.push_back(knot * range);
  return result;
}

// A force periodic in displacement. The sign of the force and two phases make all phases near.
FreeForm periodic_form(const Connection& connection, const ConnectionSize& size) {
  Candidate candidate;
  candidate.name = fmt::format("periodic in displacement {}", connection.title);
  candidate.kind = "cogging";
  candidate.channel = connection.seen;
  const std::string name = connection.component + ".cogging";
  candidate.adds.push_back({{candidate.kind, name, {}}, connection.component});
  const double travel = 2 * size.displacement;
  constexpr double kPi = std::numbers::pi;
  candidate.frees = {{name + ".force", "N", -kMostForce * size.force, kMostForce * size.force,
                      kScale * size.force, false, 0.0},
                     {name + ".pitch", "m", travel / kMostPeriods, travel / kLeastPeriods,
                      travel / (4 * kMostPeriods)},
                     {name + ".phase", "rad", -kPi, kPi, 0.5}};
  for (double periods = kLeastPeriods; periods <= kMostPeriods; periods += kPeriodStep)
    for (const double phase : {0.0, kPi / 2})
      candidate.starts.push_back(Eigen::Vector3d{kScale * size.force, travel / periods, phase});
  candidate.price = static_cast<int>(candidate.frees.size());
  return {std::move(candidate), "", {}};
}

}  // namespace

std::vector<FreeForm> dynamic_forms(const DynamicModel& model, const DynamicSizes& sizes) {
  std::vector<FreeForm> forms;
  for (std::size_t i = 0; i < model.connections.size(); ++i) {
    const ConnectionSize& size = sizes.connections[i];
    if (!(size.displacement > 0 && size.velocity > 0 && size.force > 0)) continue;
    for (const auto& kind : kKinds) forms.push_back(form_of(kind, model.connections[i], size));
    forms.push_back(periodic_form(model.connections[i], size));
  }
  return forms;
}

}  // namespace rths::diagnosis

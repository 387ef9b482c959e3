// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/bearing.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

constexpr double kFirstMove = 1e-9;          // [m]
constexpr double kMove = 5e-5;               // [m]
constexpr double kAmplitude = 0.3;           // [m]
constexpr double kProbeStep = 1e-4;          // [s]
constexpr double kLargestTemperature = 200;  // above or below the reference [°C]

const std::vector<TermSettings>& checked_terms(const Bearing& bearing) {
  for (const auto& term : bearing.terms) check_owner(term, TermOwner::Specimen);
  require_given_load(bearing);
  return bearing.terms;
}

// Moves one axis quasi-statically and records the largest ΔF/Δu.
class Probe {
 public:
  Probe(const Bearing& bearing, int axis)
      : run_{bearing, kProbeStep}, axis_{axis}, load_{bearing.axial_load} {
    force_ = force_at(0);
  }

  void go(double to, double move) {
    const auto moves = std::lround(std::abs(to - at_) / move);
    const double from = at_;
    for (long i = 1; i <= moves; ++i) {
      const double u = from + (to - from) * static_cast<double>(i) / static_cast<double>(moves);
      const double force = force_at(u);
      largest = std::max(largest, (force - force_) / (u - at_));
      force_ = force;
      at_ = u;
    }
  }

  double largest = 0;

 private:
  double force_at(double u) {
    Eigen::Vector2d displacement = Eigen::Vector2d::Zero();
    displacement[axis_] = u;
    return run_.advance(displacement, Eigen::Vector2d::Zero(), load_)[axis_];
  }

  BearingRun run_;
  int axis_;
  double load_, at_ = 0, force_ = 0;
};

}  // namespace

BearingRun::BearingRun(const Bearing& bearing, double time_step)
    : composition_{checked_terms(bearing), time_step},
      state_(composition_.states()),
      temperature_{bearing.temperature} {}

Eigen::Vector2d BearingRun::advance(const Eigen::Vector2d& displacement,
                                    const Eigen::Vector2d& velocity, double axial_load) noexcept {
  time_ += composition_.time_step();
  Quantities<double> q;
  q.time = time_;
  q.displacement = {displacement[0], displacement[1]};
  q.velocity = {velocity[0], velocity[1]};
  q.axial_load = axial_load;
  q.temperature = temperature_;
  composition_.advance(state_, q);
  return {q.force[0], q.force[1]};
}

void require_given_load(const Bearing& bearing) {
  for (const auto& term : bearing.terms) {
    const TermKind& kind = term_kind(term.kind);
    // The only vertical term that does not need the vertical displacement.
    if (kind.stage == Stage::Vertical && kind.name != "buckling_load_variation")
      throw Error{
          fmt::format("term '{}' needs a vertical displacement, but the axial load is prescribed "
                      "here: leave the term out (enabled = false)",
                      name_of(term))};
  }
}

double largest_stiffness(const Bearing& bearing) {
  Bearing resisting = bearing;
  std::erase_if(resisting.terms, [](const auto& term) {
    const Stage stage = term_kind(term.kind).stage;
    return stage < Stage::Vertical || stage > Stage::Machine;
  });
  double largest = 0;
  for (int axis = 0; axis < kHorizontalAxes; ++axis) {
    Probe probe{resisting, axis};
    probe.go(kFirstMove, kFirstMove);
    for (const double to : {kAmplitude, -kAmplitude, 0.0}) probe.go(to, kMove);
    largest = std::max(largest, probe.largest);
  }
  return largest;
}

double initial_stiffness(const Bearing& bearing) {
  const double stiffness = largest_stiffness(bearing);
  if (!(stiffness > 0) || !std::isfinite(stiffness))
    throw Error{fmt::format("bearing '{}': its stiffness is {} N/m, expected a positive number",
                            bearing.title, stiffness)};
  return stiffness;
}

Bearing read_bearing(const Config& table, double axial_load) {
  if (const auto format = table.integer("bearing", kBearingFormat); format != kBearingFormat)
    table.fail("bearing", fmt::format("format of the bearing is {}, this program reads {}", format,
                                      kBearingFormat));
  Bearing bearing{table.text("title", ""), read_terms(table, TermOwner::Specimen), axial_load,
                  table.number_in("temperature_above_reference_K", -kLargestTemperature,
                                  kLargestTemperature, 0.0)};
  table.reject_unknown_keys();
  if (bearing.terms.empty())
    throw Error{fmt::format("{}: the bearing has no terms, expected at least one", table.where())};
  return bearing;
}

}  // namespace rths::sim

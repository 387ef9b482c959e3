// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/bearing.hpp>

#include <algorithm>

namespace rths::sim {
namespace {

// Far below every yield displacement, far above round-off.
constexpr double kFirstMove = 1e-7;  // [m]
constexpr double kFirstStep = 1e-4;  // [s]

}  // namespace

BearingRun::BearingRun(const Bearing& bearing, double time_step)
    : composition_{bearing.terms, time_step}, state_(composition_.states()) {}

Eigen::Vector2d BearingRun::advance(const Eigen::Vector2d& displacement,
                                    const Eigen::Vector2d& velocity, double axial_load) noexcept {
  time_ += composition_.time_step();
  Quantities<double> q;
  q.time = time_;
  q.displacement = {displacement[0], displacement[1]};
  q.velocity = {velocity[0], velocity[1]};
  q.axial_load = axial_load;
  composition_.advance(state_, q);
  return {q.force[0], q.force[1]};
}

double initial_stiffness(const Bearing& bearing) {
  double stiffness = 0;
  for (int axis = 0; axis < kHorizontalAxes; ++axis) {
    BearingRun run{bearing, kFirstStep};
    Eigen::Vector2d move = Eigen::Vector2d::Zero();
    const double before = run.advance(move, move, bearing.axial_load)[axis];
    move[axis] = kFirstMove;
    const double after = run.advance(move, Eigen::Vector2d::Zero(), bearing.axial_load)[axis];
    stiffness = std::max(stiffness, (after - before) / kFirstMove);
  }
  return stiffness;
}

Bearing read_bearing(const Config& table, double axial_load) {
  return {table.text("title", ""), read_terms(table), axial_load};
}

}  // namespace rths::sim

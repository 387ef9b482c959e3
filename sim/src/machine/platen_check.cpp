// SPDX-License-Identifier: Apache-2.0
#include "platen_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim::machine {
namespace {

constexpr double kLongestSubstep = 1e-4;  // [s]
constexpr double kFastestMode = 0.1;      // ω substep [-]

void require_slow(const char* name, double rate, double substep, double most) {
  if (!(rate * substep <= most))
    throw Error{
        fmt::format("machine: {} is {:.6g} 1/s, expected at most {:.6g}, the limit for "
                    "substeps of {} s",
                    name, rate, most / substep, substep)};
}

double lightest(const PlatenMachine& m) { return m.mass.head<2>().minCoeff(); }

void check_rates(const PlatenMachine& m, double substep) {
  for (const Actuator* a : {&m.along_long, &m.along_lat, &m.vertical}) {
    const double spool = 2 * std::numbers::pi * a->valve_frequency;
    require_slow("the rate of a spool (valve_frequency, valve_damping)",
                 spool * std::max(1.0, 2 * a->valve_damping), substep, kFastestMode);
    const double oil = oil_stiffness(*a, m.supply, 0) / (a->piston_area * a->piston_area);
    require_slow("the rate of leakage", oil * a->leakage, substep, kFastestMode);
  }
  require_slow("the fastest mode on the oil columns",
               2 * std::numbers::pi * natural_frequencies(m)[5], substep, kFastestMode);
  const double shear = m.has_specimen ? largest_stiffness(m.specimen) : 0;
  const double friction = m.friction.coulomb.maxCoeff() / m.friction.law.presliding;
  require_slow("the rate of the specimen's shear on the platen",
               std::sqrt((shear + friction) / lightest(m)), substep, kFastestMode);
  if (!m.carries_load()) return;
  require_slow("the rate of the specimen's compression on the platen",
               std::max(std::sqrt(m.vertical_specimen.stiffness / m.mass[2]),
                        m.vertical_specimen.damping / m.mass[2]),
               substep, kFastestMode);
}

// Each actuator reaches all corners of the platen's strokes.
void check_reach(const PlatenMachine& m) {
  for (std::size_t i = 0; i < kHorizontal; ++i) {
    const double middle = (m.swivel[i] - m.base[i]).norm();
    for (unsigned corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d at = m.limits.stroke;
      for (int axis = 0; axis < 3; ++axis)
        if ((corner >> static_cast<unsigned>(axis) & 1U) != 0) at[axis] = -at[axis];
      const double moved = (at + m.swivel[i] - m.base[i]).norm() - middle;
      if (std::abs(moved) > m.actuator(i).stroke)
        throw Error{
            fmt::format("machine: horizontal actuator {} moves by {:.4g} m when the platen "
                        "is at a corner of its strokes, expected at most its stroke, {} m",
                        i + 1, moved, m.actuator(i).stroke)};
    }
  }
}

}  // namespace

int substeps_of(double period) {
  if (!(period > 0) || !std::isfinite(period))
    throw Error{fmt::format("machine: period is {} s, expected a positive number", period)};
  return std::max(1, static_cast<int>(std::ceil(period / kLongestSubstep - 1e-9)));
}

void check(const PlatenMachine& m, double substep) {
  check_rates(m, substep);
  check_reach(m);
  const double most = m.limits.force[2] - m.weight();
  if (m.carries_load() && !(m.specimen.axial_load >= 0 && m.specimen.axial_load <= most))
    throw Error{fmt::format("machine: the specimen's axial load is {} N, expected 0 to {} N",
                            m.specimen.axial_load, most)};
}

}  // namespace rths::sim::machine

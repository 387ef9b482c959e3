// SPDX-License-Identifier: Apache-2.0
#include "test_machine_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

constexpr double kLongestDelay = 1;      // [s]
constexpr double kMostDamping = 10;      // of a spool [-]
constexpr double kMostFeedback = 10;     // of pressure [-]
constexpr double kFastestWashout = 100;  // of pressure [Hz]
// An extrapolated resistance drives an oscillation with a damping ratio of -(ω substep)³/8.
constexpr double kFastestSpecimen = 0.1;  // ω substep [-]
constexpr double kUnbounded = std::numeric_limits<double>::max();

struct Bounded {
  const char* key;
  double value, low, high;
};

void require(const Bounded& b) {
  if (b.value >= b.low && b.value <= b.high) return;
  const std::string expected = b.high == kUnbounded ? fmt::format("{} or more", b.low)
                                                    : fmt::format("{} to {}", b.low, b.high);
  throw Error{fmt::format("test machine: {} is {}, expected {}", b.key, b.value, expected)};
}

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error{fmt::format("test machine: {} is {}, expected a positive number", key, value)};
}

// The model's own rates must be slow enough for the substeps of the integration.
void require_slow(const char* name, double rate, double substep, double most) {
  if (!(rate * substep <= most))
    throw Error{
        fmt::format("test machine: {} is {:.6g} 1/s, expected at most {:.6g}, the limit for "
                    "substeps of {} s",
                    name, rate, most / substep, substep)};
}

void check_hydraulics(const ServoAxis& axis) {
  require_positive("stroke", axis.limits.stroke);
  require_positive("velocity limit", axis.limits.velocity);
  require_positive("force limit", axis.limits.force);
  require_positive("piston_area", axis.piston_area);
  require_positive("oil_volume", axis.oil_volume);
  require_positive("bulk_modulus", axis.bulk_modulus);
  require_positive("supply_pressure", axis.supply_pressure);
  require_positive("rated_flow", axis.rated_flow);
  require_positive("valve_frequency", axis.valve_frequency);
  require_positive("position_gain", axis.position_gain);
  require_positive("effective_mass (with platen_inertia)", axis.effective_mass);
  for (const Bounded& bounded :
       {Bounded{"leakage", axis.leakage, 0, kUnbounded},
        Bounded{"valve_damping", axis.valve_damping, 0, kMostDamping},
        Bounded{"dead_band", axis.dead_band, 0, 1},
        Bounded{"pressure_gain", axis.pressure_gain, 0, kMostFeedback},
        Bounded{"pressure_washout", axis.pressure_washout, 0, kFastestWashout},
        Bounded{"transport_delay", axis.transport_delay, 0, kLongestDelay},
        Bounded{"force_offset", axis.force_offset, -kUnbounded, kUnbounded}})
    require(bounded);
}

void check_rates(const ServoAxis& axis, double substep) {
  const double spool = 2 * std::numbers::pi * axis.valve_frequency;
  require_slow("the rate of the spool (valve_frequency, valve_damping)",
               spool * std::max(1.0, 2 * axis.valve_damping), substep, 1);
  const double oil = 4 * axis.bulk_modulus / axis.oil_volume;
  require_slow("the rate of the oil column (bulk_modulus, oil_volume, effective_mass)",
               axis.piston_area * std::sqrt(oil / axis.effective_mass), substep, 1);
  require_slow("the rate of leakage (leakage, bulk_modulus, oil_volume)", oil * axis.leakage,
               substep, 1);
}

}  // namespace

Bearing mounted_specimen(const TestMachine& machine) {
  for (const auto& term : machine.terms) check_owner(term, TermOwner::Machine);
  Bearing mounted = machine.has_specimen ? machine.specimen : Bearing{};
  const auto is_mount = [](const auto& term) {
    return term_kind(term.kind).stage == Stage::Motion;
  };
  std::vector<TermSettings> mount;
  std::copy_if(machine.terms.begin(), machine.terms.end(), std::back_inserter(mount), is_mount);
  // The prefix avoids clashes with the specimen's terms.
  for (auto& term : mount) term.name = "machine." + name_of(term);
  mounted.terms.insert(mounted.terms.begin(), mount.begin(), mount.end());
  return mounted;
}

void check(const TestMachine& machine, double substep) {
  require({"displacement_noise", machine.noise.displacement, 0, kUnbounded});
  require({"force_noise", machine.noise.force, 0, kUnbounded});
  require({"acceleration_noise", machine.noise.acceleration, 0, kUnbounded});
  const double stiffness = machine.has_specimen ? largest_stiffness(machine.specimen) : 0;
  for (const auto& axis : machine.axes) {
    check_hydraulics(axis);
    check_rates(axis, substep);
    require_slow("the rate of the specimen on the platen (its stiffness, effective_mass)",
                 std::sqrt(std::max(0.0, stiffness) / axis.effective_mass), substep,
                 kFastestSpecimen);
  }
}

}  // namespace rths::sim

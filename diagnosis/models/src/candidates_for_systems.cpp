// SPDX-License-Identifier: Apache-2.0
#include "candidate_tables.hpp"

namespace rths::diagnosis::candidate_tables {

// Sizes begin at a few hundredths of the component's force or displacement: large enough to be
// visible, small enough not to change the rest of the model. Shapes begin at values that have an
// effect on most of the record; a wider search only takes time.
// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<CandidateTerm>& connection_entries() {
  constexpr auto kHere = kOnConnection;
  const Parameter presliding = shape_near("presliding", {0.003, 0.03});
  static const std::vector<CandidateTerm> entries{
      {"transducer_backlash", "", kHere, CandidateTerm::kSpring, {size("gap", {0.05, 0.3})}},
      {"input_dead_zone", "", kHere, CandidateTerm::kSpring, {size("half_width", {0.03, 0.15})}},
      {"large_strain_stiffening",
       "",
       kHere,
       0,
       {size("stiffness", 0.1), shape_near("onset", {0.3, 0.6})}},
      {"cubic_stiffness", "", kHere, 0, {size("stiffness", 0.03)}},
      {"asymmetric_stiffness", "", kHere, 0, {size("stiffness", 0.03)}},
      {"viscoelastic_relaxation",
       "",
       kHere,
       0,
       {size("stiffness", 0.05), shape_near("relaxation_time", {0.2, 2})}},
      {"bouc_wen",
       "",
       kHere,
       0,
       {size("characteristic_strength", 0.05), shape_near("yield_displacement", {0.2})}},
      {"degradation",
       "",
       kHere,
       CandidateTerm::kHysteresis,
       {size("strength_loss", 0.02), size("stiffness_loss", 0.02), kElasticShare}},
      {"piecewise_stiffness",
       "",
       kHere,
       0,
       {size("inside_stiffness", 0.05), shape_near("break_displacement", {0.2, 0.5})}},
      {"piecewise_damping",
       "",
       kHere,
       0,
       {size("slow_coefficient", 0.05), shape_near("break_velocity", {0.1, 0.4})}},
      {"gap_contact", "", kHere, 0, {shape_near("gap", {0.5, 0.85}), size("stiffness", 0.5)}},
      {"coulomb_friction", "", kHere, 0, {size("friction_force", 0.02), presliding}},
      {"asymmetric_friction",
       "",
       kHere,
       0,
       {size("forward_force", 0.025), size("backward_force", 0.015), presliding},
       {},
       {"coulomb_friction"},
       kWaits},
      {"stribeck_friction",
       "",
       kHere,
       0,
       {size("friction_force", 0.02), size("breakaway_force", 0.01),
        shape_near("stribeck_velocity", {0.05}), presliding},
       {},
       {"coulomb_friction"},
       kWaits},
      {"velocity_dependent_friction",
       "",
       kHere,
       0,
       {size("friction_force", 0.03), shape_near("growth_velocity", {0.05, 0.5}), presliding},
       {},
       {"coulomb_friction"},
       kWaits},
      {"position_dependent_friction",
       "",
       kHere,
       0,
       {size("friction_force", 0.03), shape("place", -1, 1, {0, 0.3, -0.3}),
        shape_near("width", {0.2}), presliding}},
      {"viscous_friction", "", kHere, 0, {size("coefficient", 0.02)}},
      {"asymmetric_viscous",
       "",
       kHere,
       0,
       {size("forward_coefficient", 0.03), size("backward_coefficient", 0.01)},
       {},
       {"viscous_friction"},
       kWaits},
      {"quadratic_drag", "", kHere, 0, {size("coefficient", 0.03)}},
      {"power_damping",
       "",
       kHere,
       0,
       {size("force", 0.03), shape_near("exponent", {0.4, 1.6}), fixed("reference_velocity", 1)},
       {},
       {"coulomb_friction", "viscous_friction", "quadratic_drag"},
       kWaits},
      {"platen_inertia", "", kHere, CandidateTerm::kAcceleration, {size("mass", 0.03)}},
  };
  return entries;
}

// Displacements are in standard deviations of the signal, times in its steps; a channel is in
// peaks.
const std::vector<CandidateTerm>& signal_entries() {
  constexpr auto kEither = kOnInput | kOnOutput;
  // No reading exceeds the range of its sensor by more than noise.
  constexpr double kLeastRange = 0.98;
  static const std::vector<CandidateTerm> entries{
      {"actuator_delay", "", kOnInput, 0, {size("delay", {1.5, 8})}},
      {"first_order_lag", "", kOnInput, 0, {size("time_constant", {1.5, 8})}},
      {"actuator_bandwidth",
       "",
       kOnInput,
       0,
       {size("time_constant", {1.5, 6}), shape_near("damping", {0.8})}},
      {"rate_saturation", "", kOnInput, 0, {size("velocity_limit", {0.3, 0.7})}},
      {"transducer_backlash", "", kEither, 0, {size("gap", {0.1, 0.6})}},
      {"input_dead_zone", "", kEither, 0, {size("half_width", {0.05, 0.3})}},
      {"gain", "", kEither, 0, {size("factor", 1.05)}},
      {"cubic_distortion", "", kEither, 0, {size("share", 0.03), fixed("range", 1)}},
      {"absolute_value_sensor", "", kEither, 0, {size("share", {0.2, 0.9})}},
      {"offset", "", kEither, 0, {size("offset", 0.01)}},
      {"drift", "", kOnOutput, 0, {size("rate", 1e-3)}},
      {"time_skew", "", kOnOutput, 0, {size("skew", {1.5, 8})}},
      {"filter_lag", "", kOnOutput, 0, {size("time_constant", {1.5, 8})}},
      {"saturation", "", kOnInput, 0, {size("limit", {0.8, 0.45})}},
      {"saturation", "", kOnOutput, 0, {size("limit", {0.97, 0.6})}},
      {"overflow", "", kOnInput, 0, {size("limit", {0.85, 0.5})}, "", {}, !kWaits, kExact},
      {"overflow",
       "",
       kOnOutput,
       0,
       {size("limit", {1, 1.2}, kLeastRange, 10)},
       "",
       {},
       !kWaits,
       kExact},
  };
  return entries;
}

}  // namespace rths::diagnosis::candidate_tables

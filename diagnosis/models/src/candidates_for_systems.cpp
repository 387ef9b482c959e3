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
      term("transducer_backlash", kHere, kSpring, {size("gap", {0.05, 0.3})}),
      term("input_dead_zone", kHere, kSpring, {size("half_width", {0.03, 0.15})}),
      term("large_strain_stiffening", kHere,
           {size("stiffness", 0.1), shape_near("onset", {0.3, 0.6})}),
      term("linear_stiffness", kHere, {size("stiffness", {0.03, 1, 5})}),
      term("cubic_stiffness", kHere, {size("stiffness", 0.03)}),
      term("asymmetric_stiffness", kHere, {size("stiffness", 0.03)}),
      term("viscoelastic_relaxation", kHere,
           {size("stiffness", 0.05), shape_near("relaxation_time", {0.2, 2})}),
      term("bouc_wen", kHere,
           {size("characteristic_strength", 0.05), shape_near("yield_displacement", {0.2})}),
      term("degradation", kHere, kHysteresis,
           {size("strength_loss", 0.02), size("stiffness_loss", 0.02), kElasticShare}),
      term("piecewise_stiffness", kHere,
           {size("inside_stiffness", 0.05), shape_near("break_displacement", {0.2, 0.5})}),
      term("piecewise_damping", kHere,
           {size("slow_coefficient", 0.05), shape_near("break_velocity", {0.1, 0.4})}),
      term("gap_contact", kHere, {shape_near("gap", {0.5, 0.85}), size("stiffness", 0.5)}),
      term("coulomb_friction", kHere, {size("friction_force", 0.02), presliding}),
      after({"coulomb_friction"},
            term("asymmetric_friction", kHere,
                 {size("forward_force", 0.025), size("backward_force", 0.015), presliding})),
      after({"coulomb_friction"}, term("stribeck_friction", kHere,
                                       {size("friction_force", 0.02), size("breakaway_force", 0.01),
                                        shape_near("stribeck_velocity", {0.05}), presliding})),
      after({"coulomb_friction"}, term("velocity_dependent_friction", kHere,
                                       {size("friction_force", 0.03),
                                        shape_near("growth_velocity", {0.05, 0.5}), presliding})),
      term("position_dependent_friction", kHere,
           {size("friction_force", 0.03), shape("place", -1, 1, {0, 0.3, -0.3}),
            shape_near("width", {0.2}), presliding}),
      term("viscous_friction", kHere, {size("coefficient", 0.02)}),
      after({"viscous_friction"},
            term("asymmetric_viscous", kHere,
                 {size("forward_coefficient", 0.03), size("backward_coefficient", 0.01)})),
      term("quadratic_drag", kHere, {size("coefficient", 0.03)}),
      after({"coulomb_friction", "viscous_friction", "quadratic_drag"},
            term("power_damping", kHere,
                 {size("force", 0.03), shape_near("exponent", {0.4, 1.6}),
                  fixed("reference_velocity", 1)})),
      term("platen_inertia", kHere, kAcceleration, {size("mass", 0.03)}),
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
      term("actuator_delay", kOnInput, {size("delay", {1.5, 8})}),
      term("first_order_lag", kOnInput, {size("time_constant", {1.5, 8})}),
      term("actuator_bandwidth", kOnInput,
           {size("time_constant", {1.5, 6}), shape_near("damping", {0.8})}),
      term("rate_saturation", kOnInput, {size("velocity_limit", {0.3, 0.7})}),
      term("transducer_backlash", kEither, {size("gap", {0.1, 0.6})}),
      term("input_dead_zone", kEither, {size("half_width", {0.05, 0.3})}),
      term("gain", kEither, {size("factor", 1.05)}),
      term("cubic_distortion", kEither, {size("share", 0.03), fixed("range", 1)}),
      term("absolute_value_sensor", kEither, {size("share", {0.2, 0.9})}),
      term("offset", kEither, {size("offset", 0.01)}),
      term("drift", kOnOutput, {size("rate", 1e-3)}),
      term("time_skew", kOnOutput, {size("skew", {1.5, 8})}),
      term("filter_lag", kOnOutput, {size("time_constant", {1.5, 8})}),
      term("saturation", kOnInput, {size("limit", {0.8, 0.45})}),
      term("saturation", kOnOutput, {size("limit", {0.97, 0.6})}),
      exact(term("overflow", kOnInput, {size("limit", {0.85, 0.5})})),
      exact(term("overflow", kOnOutput, {size("limit", {1, 1.2}, kLeastRange, 10)})),
  };
  return entries;
}

}  // namespace rths::diagnosis::candidate_tables

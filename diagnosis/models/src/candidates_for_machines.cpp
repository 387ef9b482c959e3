// SPDX-License-Identifier: Apache-2.0
#include "candidate_tables.hpp"

namespace rths::diagnosis::candidate_tables {

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<CandidateTerm>& machine_entries() {
  static const std::vector<CandidateTerm> entries{
      term("support_flexibility", kOnForce, kHidden,
           {size("flexibility", 0.01), fixed("stiffness_estimate", 5)}),
      term("mount_slack", kOnForce,
           {size("slack", {0.003, 0.013, 0.1}, 0, 1), fixed("seating_force", 0.007),
            fixed("stiffness_estimate", 5)}),
      term("transducer_backlash", kOnForce, {size("gap", {0.003, 0.013, 0.1}, 0, 1)}),
      term("coulomb_friction", kOnForce, {size("friction_force", 0.004, kEachAxis), kPresliding}),
      term("planar_friction", kOnForce, kTwoAxes, {size("friction_force", 0.004), kPresliding}),
      including({"coulomb_friction"},
                term("asymmetric_friction", kOnForce,
                     {size("forward_force", 0.004, kEachAxis),
                      size("backward_force", 0.003, kEachAxis), kPresliding})),
      term("load_dependent_friction", kOnForce, kAxialLoad,
           {size("friction_coefficient", 1e-3), kPresliding}),
      including({"coulomb_friction"},
                term("stribeck_friction", kOnForce,
                     {size("friction_force", 0.004, kEachAxis), size("breakaway_force", 0.004),
                      shape("stribeck_velocity", 0.004, 0.6, {0.025, 0.1}), kPresliding})),
      after({"coulomb_friction"},
            term("velocity_dependent_friction", kOnForce,
                 {size("friction_force", 0.01, kEachAxis),
                  shape("growth_velocity", 0.002, 5, {0.05, 0.5}), kPresliding})),
      term("position_dependent_friction", kOnForce,
           {size("friction_force", 0.01), shape("place", -1, 1, {0.2, -0.2, 0}),
            shape("width", 0.02, 1, {0.15}), kPresliding}),
      term("viscous_friction", kOnForce, {size("coefficient", 0.003, kEachAxis)}),
      including({"viscous_friction"}, term("asymmetric_viscous", kOnForce,
                                           {size("forward_coefficient", 0.004, kEachAxis),
                                            size("backward_coefficient", 0.002, kEachAxis)})),
      term("quadratic_drag", kOnForce, {size("coefficient", 0.003)}),
      after({"coulomb_friction", "viscous_friction", "quadratic_drag"},
            replacing({"viscous_friction", "quadratic_drag"},
                      term("power_damping", kOnForce,
                           {size("force", 0.003), shape("exponent", 0.1, 3, {0.4, 1.6}),
                            fixed("reference_velocity", 1)}))),
      term("gap_contact", kOnForce, {size("stiffness", 0.1), shape("gap", 0.05, 1, {0.5, 0.85})}),
      term("platen_inertia", kOnForce, {size("mass", 0.02, kEachAxis)}),
  };
  return entries;
}

const std::vector<CandidateTerm>& sensor_entries() {
  static const std::vector<CandidateTerm> entries{
      term("offset", kOnForce, {size("offset", 0.01, kEachAxis)}),
      term("drift", kOnForce, {size("rate", 0.01, kEachAxis)}),
      term("gain", kOnForce, {size("factor", 1.01, kEachAxis)}),
      term("saturation", kOnForce, {size("limit", {0.985, 0.95, 0.88}, 0.3, 1.5)}),
      term("crosstalk_horizontal", kOnForce, kTwoAxes,
           {size("lat_into_long", 0.005), size("long_into_lat", 0.005)}),
      term("crosstalk_vertical", kOnForce, kAxialLoad,
           {size("share", 0.003, kEachAxis), fixed("reference_load", 1)}),
      term("time_skew", kOnForce, {size("skew", 1e-3)}),
      term("clock_drift", kOnForce, {size("skew", 1e-3), size("rate", 5e-5)}),
      term("filter_lag", kOnForce, {size("time_constant", 1e-3)}),
      term("absolute_value_sensor", kOnForce, {size("share", 0.01)}),

      term("gain", kOnAccelerometer, {size("factor", 1.01, kEachAxis)}),
      term("drift", kOnAccelerometer, {size("rate", 0.01, kEachAxis)}),
      term("accelerometer_tilt", kOnAccelerometer,
           {size("tilt_per_displacement", 0.01, kEachAxis)}),
      term("time_skew", kOnAccelerometer, {size("skew", 1e-3)}),
      term("cubic_distortion", kOnAccelerometer, {size("share", 0.01), fixed("range", 1)}),
  };
  return entries;
}

const std::vector<CandidateTerm>& actuator_entries() {
  static const std::vector<CandidateTerm> entries{
      term("actuator_delay", kOnActuator, {size("delay", 4e-3)}),
      term("first_order_lag", kOnActuator, {size("time_constant", 4e-3)}),
      term("actuator_bandwidth", kOnActuator,
           {size("time_constant", 6e-3), shape("damping", 0.05, 5, {0.8})}),
      term("oil_column_resonance", kOnActuator,
           {size("time_constant", {5.5e-3, 7e-3, 9e-3}), shape("damping", 0.02, 1, {0.1})}),
      named("rate_saturation", "largest velocity of the actuator",
            term("actuator_bandwidth", kOnActuator, kKindInModel,
                 {size("velocity_limit", {1, 0.98, 0.95}, 0.2, 2)})),
      named("valve_deadband", "dead band of the servo valve",
            term("actuator_bandwidth", kOnActuator, kKindInModel,
                 {size("dead_band", {0.003, 0.01}, 0, 0.3)})),
      term("rate_saturation", kOnActuator, kNoServoLoop,
           {size("velocity_limit", {1, 0.98, 0.95}, 0.2, 2)}),
      term("valve_deadband", kOnActuator, kNoServoLoop,
           {size("dead_band", {0.003, 0.01}, 0, 0.3), shape("time_constant", 1e-3, 0.1, {5e-3})}),
      term("load_compliance", kOnActuator, kLoadCell,
           {size("compliance", 0.01), shape("time_constant", 1e-4, 0.05, {2e-3}),
            fixed("stiffness_estimate", 0)}),
      term("gain", kOnActuator, {size("factor", 1.01, kEachAxis)}),
  };
  return entries;
}

}  // namespace rths::diagnosis::candidate_tables

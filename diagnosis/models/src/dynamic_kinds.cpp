// SPDX-License-Identifier: Apache-2.0
#include "dynamic_kinds.hpp"

namespace rths::diagnosis {

double size_of(NaturalUnit unit, const Natural& n) {
  switch (unit) {
    case NaturalUnit::Displacement:
      return n.displacement;
    case NaturalUnit::Velocity:
      return n.velocity;
    case NaturalUnit::Force:
      return n.force;
    case NaturalUnit::Stiffness:
      return n.force / n.displacement;
    case NaturalUnit::Quadratic:
      return n.force / (n.displacement * n.displacement);
    case NaturalUnit::Cubic:
      return n.force / (n.displacement * n.displacement * n.displacement);
    case NaturalUnit::Damping:
      return n.force / n.velocity;
    case NaturalUnit::Drag:
      return n.force / (n.velocity * n.velocity);
    case NaturalUnit::Mass:
      return n.force / n.acceleration;
    case NaturalUnit::PerWork:
      return 1 / (n.force * n.displacement);
    case NaturalUnit::Peak:
      return n.peak;
    case NaturalUnit::Rms:
      return n.rms;
    case NaturalUnit::Rate:
      return n.velocity;
    case NaturalUnit::TimeStep:
      return n.time_step;
    case NaturalUnit::Period:
      return n.period;
    case NaturalUnit::One:
      break;
  }
  return 1;
}

// Sizes begin at a few hundredths of the component's force or displacement: large enough to be
// visible, small enough not to change the rest of the model. Shapes begin at values that have an
// effect on most of the record.
const std::vector<KindChoice>& connection_kinds() {
  static const std::vector<KindChoice> kinds = {
      {"transducer_backlash", {{"gap", NaturalUnit::Displacement, {0.05, 0.3}}}},
      {"input_dead_zone", {{"half_width", NaturalUnit::Displacement, {0.03, 0.15}}}},
      {"large_strain_stiffening",
       {{"stiffness", NaturalUnit::Stiffness, {0.1}},
        {"onset", NaturalUnit::Displacement, {0.3, 0.6}, ParameterChoice::Shape}}},
      {"cubic_stiffness", {{"stiffness", NaturalUnit::Cubic, {0.03}}}},
      {"asymmetric_stiffness", {{"stiffness", NaturalUnit::Quadratic, {0.03}}}},
      {"viscoelastic_relaxation",
       {{"stiffness", NaturalUnit::Stiffness, {0.05}},
        {"relaxation_time", NaturalUnit::Period, {0.2, 2}, ParameterChoice::Shape}}},
      {"bouc_wen",
       {{"characteristic_strength", NaturalUnit::Force, {0.05}},
        {"yield_displacement", NaturalUnit::Displacement, {0.2}, ParameterChoice::Shape}}},
      {"degradation",
       {{"strength_loss", NaturalUnit::PerWork, {0.02}},
        {"stiffness_loss", NaturalUnit::PerWork, {0.02}},
        {"elastic_share", NaturalUnit::One, {0.5}, ParameterChoice::Shape}}},
      {"piecewise_stiffness",
       {{"inside_stiffness", NaturalUnit::Stiffness, {0.05}},
        {"break_displacement", NaturalUnit::Displacement, {0.2, 0.5}, ParameterChoice::Shape}}},
      {"piecewise_damping",
       {{"slow_coefficient", NaturalUnit::Damping, {0.05}},
        {"break_velocity", NaturalUnit::Velocity, {0.1, 0.4}, ParameterChoice::Shape}}},
      {"gap_contact",
       {{"gap", NaturalUnit::Displacement, {0.5, 0.85}, ParameterChoice::Shape},
        {"stiffness", NaturalUnit::Stiffness, {0.5}}}},
      {"coulomb_friction",
       {{"friction_force", NaturalUnit::Force, {0.02}},
        {"presliding", NaturalUnit::Displacement, {0.003, 0.03}, ParameterChoice::Shape}}},
      {"asymmetric_friction",
       {{"forward_force", NaturalUnit::Force, {0.025}},
        {"backward_force", NaturalUnit::Force, {0.015}},
        {"presliding", NaturalUnit::Displacement, {0.003, 0.03}, ParameterChoice::Shape}},
       {"coulomb_friction"}},
      {"stribeck_friction",
       {{"friction_force", NaturalUnit::Force, {0.02}},
        {"breakaway_force", NaturalUnit::Force, {0.01}},
        {"stribeck_velocity", NaturalUnit::Velocity, {0.05}, ParameterChoice::Shape},
        {"presliding", NaturalUnit::Displacement, {0.003, 0.03}, ParameterChoice::Shape}},
       {"coulomb_friction"}},
      {"velocity_dependent_friction",
       {{"friction_force", NaturalUnit::Force, {0.03}},
        {"growth_velocity", NaturalUnit::Velocity, {0.05, 0.5}, ParameterChoice::Shape},
        {"presliding", NaturalUnit::Displacement, {0.003, 0.03}, ParameterChoice::Shape}},
       {"coulomb_friction"}},
      {"viscous_friction", {{"coefficient", NaturalUnit::Damping, {0.02}}}},
      {"asymmetric_viscous",
       {{"forward_coefficient", NaturalUnit::Damping, {0.03}},
        {"backward_coefficient", NaturalUnit::Damping, {0.01}}},
       {"viscous_friction"}},
      {"quadratic_drag", {{"coefficient", NaturalUnit::Drag, {0.03}}}},
      {"power_damping",
       {{"force", NaturalUnit::Force, {0.03}},
        {"exponent", NaturalUnit::One, {0.4, 1.6}, ParameterChoice::Shape},
        {"reference_velocity", NaturalUnit::Velocity, {1}, ParameterChoice::Stated}},
       {"coulomb_friction", "viscous_friction", "quadratic_drag"}},
      {"platen_inertia", {{"mass", NaturalUnit::Mass, {0.03}}}}};
  return kinds;
}

namespace {

// Kinds for any signal, between those for the signal's own type.
std::vector<KindChoice> with_signal_kinds(std::vector<KindChoice> before,
                                          const std::vector<KindChoice>& behind) {
  const std::vector<KindChoice> either = {
      {"transducer_backlash", {{"gap", NaturalUnit::Rms, {0.1, 0.6}}}},
      {"input_dead_zone", {{"half_width", NaturalUnit::Rms, {0.05, 0.3}}}},
      {"gain", {{"factor", NaturalUnit::One, {1.05}}}},
      {"cubic_distortion",
       {{"share", NaturalUnit::One, {0.03}},
        {"range", NaturalUnit::Peak, {1}, ParameterChoice::Stated}}},
      {"absolute_value_sensor", {{"share", NaturalUnit::One, {0.2, 0.9}}}},
      {"offset", {{"offset", NaturalUnit::Rms, {0.03}}}}};
  before.insert(before.end(), either.begin(), either.end());
  before.insert(before.end(), behind.begin(), behind.end());
  return before;
}

}  // namespace

const std::vector<KindChoice>& input_kinds() {
  static const auto kinds =
      with_signal_kinds({{"actuator_delay", {{"delay", NaturalUnit::TimeStep, {1.5, 8}}}},
                         {"first_order_lag", {{"time_constant", NaturalUnit::TimeStep, {1.5, 8}}}},
                         {"actuator_bandwidth",
                          {{"time_constant", NaturalUnit::TimeStep, {1.5, 6}},
                           {"damping", NaturalUnit::One, {0.8}, ParameterChoice::Shape}}},
                         {"rate_saturation", {{"velocity_limit", NaturalUnit::Rate, {0.3, 0.7}}}}},
                        {{"saturation", {{"limit", NaturalUnit::Peak, {0.8, 0.45}}}},
                         {"overflow", {{"limit", NaturalUnit::Peak, {0.85, 0.5}}}}});
  return kinds;
}

const std::vector<KindChoice>& output_kinds() {
  static const auto kinds =
      with_signal_kinds({}, {{"drift", {{"rate", NaturalUnit::Rate, {1e-3}}}},
                             {"time_skew", {{"skew", NaturalUnit::TimeStep, {1.5, 8}}}},
                             {"filter_lag", {{"time_constant", NaturalUnit::TimeStep, {1.5, 8}}}},
                             {"saturation", {{"limit", NaturalUnit::Peak, {0.97, 0.6}}}},
                             {"overflow", {{"limit", NaturalUnit::Peak, {1, 1.5}}}}});
  return kinds;
}

}  // namespace rths::diagnosis

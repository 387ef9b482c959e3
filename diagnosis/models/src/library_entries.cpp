// SPDX-License-Identifier: Apache-2.0
#include "library.hpp"

namespace rths::diagnosis {
namespace {

constexpr auto kSize = ParameterSpecification::Role::Size;
constexpr auto kShape = ParameterSpecification::Role::Shape;
constexpr auto kFixed = ParameterSpecification::Role::Fixed;
constexpr bool kEachAxis = true;

ParameterSpecification size(std::string_view parameter, double start, bool each_axis = false) {
  return {parameter, kSize, {start}, 1, 0, 0, each_axis};
}
ParameterSpecification shape(std::string_view parameter, double low, double high, double start) {
  return {parameter, kShape, {start}, 1, low, high, false};
}
ParameterSpecification shape(std::string_view parameter, double low, double high, double first,
                             double second) {
  return {parameter, kShape, {first, second}, 2, low, high, false};
}
ParameterSpecification shape(std::string_view parameter, double low, double high, double first,
                             double second, double third) {
  return {parameter, kShape, {first, second, third}, 3, low, high, false};
}
ParameterSpecification fixed(std::string_view parameter, double value) {
  return {parameter, kFixed, {value}, 1, 0, 0, false};
}

// Share of a loss of strength that also softens the bearing before it yields: unknown, so it is
// fitted.
const ParameterSpecification kElasticShare = shape("elastic_share", 0, 1, 0.5);

// Elastic displacement of a guide before it slides.
const ParameterSpecification kPresliding = shape("presliding", 1e-5, 0.3, 0.002);

const std::vector<Entry>& bearing_entries() {
  static const std::vector<Entry> entries{
      {"adiabatic_heating",
       "",
       Target::Force,
       Entry::kHysteresis,
       {size("softening", 0.01), shape("cooling_time", 0.5, 1e5, 100, 5), kElasticShare}},
      {"axial_load_strength",
       "",
       Target::Force,
       Entry::kAxialLoad | Entry::kHysteresis,
       {size("coefficient", 0.05), fixed("reference_load", 1), kElasticShare}},
      {"axial_load_stiffness",
       "",
       Target::Force,
       Entry::kAxialLoad | Entry::kHysteresis,
       {size("coefficient", 0.02), fixed("reference_load", 1)}},
      {"p_delta", "", Target::Force, Entry::kAxialLoad, {size("coefficient", 0.003)}},
      {"bouc_wen",
       "bidirectional_coupling",
       Target::Force,
       Entry::kKindInModel | Entry::kTwoAxes,
       {size("coupling", 0.8)},
       "coupling of the axes"},
      {"large_strain_stiffening",
       "",
       Target::Force,
       0,
       {size("stiffness", 0.05), shape("onset", 0.05, 1, 0.5, 0.75)}},
      {"cubic_stiffness", "", Target::Force, 0, {size("stiffness", 0.01)}},
      {"scragging",
       "",
       Target::Force,
       Entry::kHysteresis,
       {size("virgin_excess", 0.1), shape("scragging_displacement", 0.03, 4, 0.3, 0.8)}},
      {"rate_dep_strength",
       "",
       Target::Force,
       Entry::kHysteresis,
       {size("coefficient", 0.02), shape("reference_velocity", 1e-3, 1.5, 0.0125, 0.125),
        kElasticShare}},
      {"viscoelastic_relaxation",
       "",
       Target::Force,
       0,
       {size("stiffness", 0.02), shape("relaxation_time", 0.01, 50, 1, 0.2, 0.04)}},
      {"asymmetric_stiffness", "", Target::Force, 0, {size("stiffness", 0.01, kEachAxis)}},
      {"degradation",
       "",
       Target::Force,
       Entry::kHysteresis,
       {size("strength_loss", 0.02), size("stiffness_loss", 0.02), kElasticShare}},
      {"hysteresis_shape",
       "",
       Target::Force,
       Entry::kHysteresis,
       {size("force_1", 0.002), size("force_2", 0.002), size("force_3", 0.002),
        size("force_4", 0.002), shape("length", 0.002, 0.05, 0.008)}},
  };
  return entries;
}

const std::vector<Entry>& rule_and_device_entries() {
  static const std::vector<Entry> entries{
      {"bouc_wen",
       "unloading_rule",
       Target::Force,
       Entry::kRule | Entry::kKindInModel,
       {shape("beta", 0.01, 1, 0.2, 0.8)},
       "another unloading (beta)"},
      {"bouc_wen",
       "second_loop",
       Target::Force,
       Entry::kRule | Entry::kBeside,
       {size("characteristic_strength", 0.1), shape("yield_displacement", 1e-3, 1, 0.3, 0.05),
        shape("eta", 1, 6, 2)},
       "a second loop beside the first"},
      {"bouc_wen_slip",
       "",
       Target::Force,
       Entry::kRule | Entry::kInstead,
       {size("slip_length", 0.02), shape("slip_width", 0.05, 1, 0.2)}},
      {"ageing_temperature",
       "",
       Target::Force,
       Entry::kTemperature | Entry::kHysteresis,
       {size("stiffness_temperature", 0.004), size("strength_temperature", 0.004)}},
      {"velocity_dep_sliding",
       "",
       Target::Force,
       Entry::kSlider,
       {size("low_velocity_reduction", 0.2), shape("rate", 2, 500, 20, 80)}},
      {"bouc_wen",
       "",
       Target::Force,
       Entry::kNoHysteresis,
       {size("characteristic_strength", 0.3), shape("yield_displacement", 1e-3, 1, 0.03, 0.2)}},
      {"asymmetric_hysteresis",
       "",
       Target::Force,
       Entry::kNoHysteresis,
       {size("forward_force", 0.3), size("backward_force", 0.3),
        shape("forward_length", 1e-4, 1, 0.03, 0.15), shape("backward_length", 1e-4, 1, 0.03),
        size("play", 0.1)}},
      {"current_dependent_friction",
       "",
       Target::Force,
       Entry::kAuxiliary,
       {size("friction_force", 0.1), size("force_per_current", 0.5),
        size("force_per_current2", 0.01), kPresliding, shape("creep_velocity", 1e-5, 1, 0.02)}},
      {"current_dependent_damping",
       "",
       Target::Force,
       Entry::kAuxiliary,
       {size("coefficient_per_current", 0.5), size("coefficient_per_current2", 0.01)}},
      {"control_lag",
       "",
       Target::Force,
       Entry::kAuxiliary | Entry::kControlledTerm,
       {{"time_constant", kSize, {0.003, 0.02, 0.1}, 3, 0, 0, false}}},
      {"control_delay",
       "",
       Target::Force,
       Entry::kAuxiliary | Entry::kControlledTerm,
       {{"delay", kSize, {0.003, 0.02}, 2, 0, 0, false}}},
  };
  return entries;
}

const std::vector<Entry>& machine_entries() {
  static const std::vector<Entry> entries{
      {"support_flexibility",
       "",
       Target::Force,
       Entry::kHidden,
       {size("flexibility", 0.01), fixed("stiffness_estimate", 5)}},
      {"mount_slack",
       "",
       Target::Force,
       0,
       {{"slack", kSize, {0.003, 0.013, 0.1}, 3, 0, 1, false},
        fixed("seating_force", 0.007),
        fixed("stiffness_estimate", 5)}},
      {"transducer_backlash",
       "",
       Target::Force,
       0,
       {{"gap", kSize, {0.003, 0.013, 0.1}, 3, 0, 1, false}}},
      {"coulomb_friction",
       "",
       Target::Force,
       0,
       {size("friction_force", 0.004, kEachAxis), kPresliding}},
      {"planar_friction",
       "",
       Target::Force,
       Entry::kTwoAxes,
       {size("friction_force", 0.004), kPresliding}},
      {"asymmetric_friction",
       "",
       Target::Force,
       0,
       {size("forward_force", 0.004, kEachAxis), size("backward_force", 0.003, kEachAxis),
        kPresliding}},
      {"load_dependent_friction",
       "",
       Target::Force,
       Entry::kAxialLoad,
       {size("friction_coefficient", 1e-3), kPresliding}},
      {"stribeck_friction",
       "",
       Target::Force,
       0,
       {size("friction_force", 0.004, kEachAxis), size("breakaway_force", 0.004),
        shape("stribeck_velocity", 0.004, 0.6, 0.025, 0.1), kPresliding}},
      {"velocity_dependent_friction",
       "",
       Target::Force,
       0,
       {size("friction_force", 0.01, kEachAxis), shape("growth_velocity", 0.002, 5, 0.05, 0.5),
        kPresliding}},
      {"position_dependent_friction",
       "",
       Target::Force,
       0,
       {size("friction_force", 0.01), shape("place", -1, 1, 0.2, -0.2, 0),
        shape("width", 0.02, 1, 0.15), kPresliding}},
      {"viscous_friction", "", Target::Force, 0, {size("coefficient", 0.003, kEachAxis)}},
      {"asymmetric_viscous",
       "",
       Target::Force,
       0,
       {size("forward_coefficient", 0.004, kEachAxis),
        size("backward_coefficient", 0.002, kEachAxis)}},
      {"quadratic_drag", "", Target::Force, 0, {size("coefficient", 0.003)}},
      {"power_damping",
       "",
       Target::Force,
       0,
       {size("force", 0.003), shape("exponent", 0.1, 3, 0.4, 1.6), fixed("reference_velocity", 1)}},
      {"platen_inertia", "", Target::Force, 0, {size("mass", 0.02, kEachAxis)}},
  };
  return entries;
}

const std::vector<Entry>& sensor_entries() {
  static const std::vector<Entry> entries{
      {"offset", "", Target::Force, 0, {size("offset", 0.01, kEachAxis)}},
      {"drift", "", Target::Force, 0, {size("rate", 0.01, kEachAxis)}},
      {"gain", "", Target::Force, 0, {size("factor", 1.01, kEachAxis)}},
      {"saturation",
       "",
       Target::Force,
       0,
       {{"limit", kSize, {0.985, 0.95, 0.88}, 3, 0.3, 1.5, false}}},
      {"crosstalk_horizontal",
       "",
       Target::Force,
       Entry::kTwoAxes,
       {size("lat_into_long", 0.005), size("long_into_lat", 0.005)}},
      {"crosstalk_vertical",
       "",
       Target::Force,
       Entry::kAxialLoad,
       {size("share", 0.003, kEachAxis), fixed("reference_load", 1)}},
      {"time_skew", "", Target::Force, 0, {size("skew", 1e-3)}},
      {"clock_drift", "", Target::Force, 0, {size("skew", 1e-3), size("rate", 5e-5)}},
      {"filter_lag", "", Target::Force, 0, {size("time_constant", 1e-3)}},
      {"absolute_value_sensor", "", Target::Force, 0, {size("share", 0.01)}},

      {"gain", "", Target::Accelerometer, 0, {size("factor", 1.01, kEachAxis)}},
      {"drift", "", Target::Accelerometer, 0, {size("rate", 0.01, kEachAxis)}},
      {"accelerometer_tilt",
       "",
       Target::Accelerometer,
       0,
       {size("tilt_per_displacement", 0.01, kEachAxis)}},
      {"time_skew", "", Target::Accelerometer, 0, {size("skew", 1e-3)}},
      {"cubic_distortion", "", Target::Accelerometer, 0, {size("share", 0.01), fixed("range", 1)}},
  };
  return entries;
}

const std::vector<Entry>& actuator_entries() {
  static const std::vector<Entry> entries{
      {"actuator_delay", "", Target::Actuator, 0, {size("delay", 4e-3)}},
      {"first_order_lag", "", Target::Actuator, 0, {size("time_constant", 4e-3)}},
      {"actuator_bandwidth",
       "",
       Target::Actuator,
       0,
       {size("time_constant", 6e-3), shape("damping", 0.05, 5, 0.8)}},
      {"oil_column_resonance",
       "",
       Target::Actuator,
       0,
       {{"time_constant", kSize, {5.5e-3, 7e-3, 9e-3}, 3, 0, 0, false},
        shape("damping", 0.02, 1, 0.1)}},
      {"actuator_bandwidth",
       "rate_saturation",
       Target::Actuator,
       Entry::kKindInModel,
       {{"velocity_limit", kSize, {1, 0.98, 0.95}, 3, 0.2, 2, false}},
       "largest velocity of the actuator"},
      {"actuator_bandwidth",
       "valve_deadband",
       Target::Actuator,
       Entry::kKindInModel,
       {{"dead_band", kSize, {0.003, 0.01}, 2, 0, 0.3, false}},
       "dead band of the servo valve"},
      {"rate_saturation",
       "",
       Target::Actuator,
       Entry::kNoServoLoop,
       {{"velocity_limit", kSize, {1, 0.98, 0.95}, 3, 0.2, 2, false}}},
      {"valve_deadband",
       "",
       Target::Actuator,
       Entry::kNoServoLoop,
       {{"dead_band", kSize, {0.003, 0.01}, 2, 0, 0.3, false},
        shape("time_constant", 1e-3, 0.1, 5e-3)}},
      {"load_compliance",
       "",
       Target::Actuator,
       Entry::kLoadCell,
       {size("compliance", 0.01), shape("time_constant", 1e-4, 0.05, 2e-3),
        fixed("stiffness_estimate", 0)}},
      {"gain", "", Target::Actuator, 0, {size("factor", 1.01, kEachAxis)}},
  };
  return entries;
}

}  // namespace

std::span<const Entry> library() {
  static const std::vector<Entry> all_entries = [] {
    std::vector<Entry> all;
    for (const auto* entries : {&bearing_entries(), &rule_and_device_entries(), &machine_entries(),
                                &sensor_entries(), &actuator_entries()})
      all.insert(all.end(), entries->begin(), entries->end());
    return all;
  }();
  return all_entries;
}

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "candidate_terms.hpp"

#include <algorithm>

namespace rths::diagnosis {
namespace {

using Parameter = CandidateParameter;

constexpr auto kSize = Parameter::Role::Size;
constexpr auto kShape = Parameter::Role::Shape;
constexpr auto kFixed = Parameter::Role::Fixed;
constexpr auto kTypical = Parameter::Role::Typical;
constexpr bool kEachAxis = true, kExact = true, kWaits = true;

Parameter size(std::string_view parameter, double start, bool each_axis = false) {
  return {parameter, kSize, {start}, 0, 0, each_axis};
}
Parameter size(std::string_view parameter, std::vector<double> starts, double low = 0,
               double high = 0) {
  return {parameter, kSize, std::move(starts), low, high, false};
}
Parameter shape(std::string_view parameter, double low, double high, std::vector<double> starts) {
  return {parameter, kShape, std::move(starts), low, high, false};
}
// From a tenth of the smallest start to ten times the largest one.
Parameter shape_near(std::string_view parameter, std::vector<double> starts) {
  constexpr double kRange = 10;
  const auto [least, most] = std::minmax_element(starts.begin(), starts.end());
  const double low = *least / kRange, high = *most * kRange;
  return shape(parameter, low, high, std::move(starts));
}
Parameter fixed(std::string_view parameter, double value) {
  return {parameter, kFixed, {value}, 0, 0, false};
}

Parameter typical(std::string_view parameter) { return {parameter, kTypical, {}, 0, 0, false}; }

// Share of a loss of strength that also softens the bearing before it yields: unknown, so it is
// fitted.
const Parameter kElasticShare = shape("elastic_share", 0, 1, {0.5});

// Elastic displacement of a guide before it slides.
const Parameter kPresliding = shape("presliding", 1e-5, 0.3, {0.002});

const std::vector<CandidateTerm>& bearing_entries() {
  static const std::vector<CandidateTerm> entries{
      {"adiabatic_heating",
       "",
       kOnForce,
       CandidateTerm::kHysteresis,
       {size("softening", 0.01), shape("cooling_time", 0.5, 1e5, {100, 5}), kElasticShare}},
      {"axial_load_strength",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad | CandidateTerm::kHysteresis,
       {size("coefficient", 0.05), fixed("reference_load", 1), kElasticShare}},
      {"axial_load_stiffness",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad | CandidateTerm::kHysteresis,
       {size("coefficient", 0.02), fixed("reference_load", 1)}},
      {"p_delta", "", kOnForce, CandidateTerm::kAxialLoad, {size("coefficient", 0.003)}},
      {"bouc_wen",
       "bidirectional_coupling",
       kOnForce,
       CandidateTerm::kKindInModel | CandidateTerm::kTwoAxes,
       {size("coupling", 0.8)},
       "coupling of the axes"},
      {"large_strain_stiffening",
       "",
       kOnForce,
       0,
       {size("stiffness", 0.05), shape("onset", 0.05, 1, {0.5, 0.75})}},
      {"cubic_stiffness", "", kOnForce, 0, {size("stiffness", 0.01)}},
      {"scragging",
       "",
       kOnForce,
       CandidateTerm::kHysteresis,
       {size("virgin_excess", 0.1), shape("scragging_displacement", 0.03, 4, {0.3, 0.8})}},
      {"rate_dep_strength",
       "",
       kOnForce,
       CandidateTerm::kHysteresis,
       {size("coefficient", 0.02), shape("reference_velocity", 1e-3, 1.5, {0.0125, 0.125}),
        kElasticShare}},
      {"viscoelastic_relaxation",
       "",
       kOnForce,
       0,
       {size("stiffness", 0.02), shape("relaxation_time", 0.01, 50, {1, 0.2, 0.04})}},
      {"asymmetric_stiffness", "", kOnForce, 0, {size("stiffness", 0.01, kEachAxis)}},
      {"degradation",
       "",
       kOnForce,
       CandidateTerm::kHysteresis,
       {size("strength_loss", 0.02), size("stiffness_loss", 0.02), kElasticShare}},
      {"hysteresis_shape",
       "",
       kOnForce,
       CandidateTerm::kHysteresis | CandidateTerm::kCorrectsForm,
       {size("force_1", 0.002), size("force_2", 0.002), size("force_3", 0.002),
        size("force_4", 0.002), shape("length", 0.002, 0.05, {0.008})}},
  };
  return entries;
}

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<CandidateTerm>& rule_and_device_entries() {
  static const std::vector<CandidateTerm> entries{
      {"bouc_wen",
       "unloading_rule",
       kOnForce,
       CandidateTerm::kRule | CandidateTerm::kKindInModel,
       {shape("beta", 0.01, 1, {0.2, 0.8})},
       "another unloading (beta)"},
      {"bouc_wen",
       "second_loop",
       kOnForce,
       CandidateTerm::kRule | CandidateTerm::kBeside,
       {size("characteristic_strength", 0.1), shape("yield_displacement", 1e-3, 1, {0.3, 0.05}),
        shape("eta", 1, 6, {2})},
       "a second loop beside the first"},
      {"bouc_wen_slip",
       "",
       kOnForce,
       CandidateTerm::kRule | CandidateTerm::kInstead,
       {size("slip_length", 0.02), shape("slip_width", 0.05, 1, {0.2})}},
      {"ageing_temperature",
       "",
       kOnForce,
       CandidateTerm::kTemperature | CandidateTerm::kHysteresis,
       {size("stiffness_temperature", 0.004), size("strength_temperature", 0.004)}},
      {"friction_heating",
       "",
       kOnForce,
       CandidateTerm::kSlider,
       {size("heat_share", 0.5), shape("contact_area", 1e-6, 1e6, {1, 10, 0.1})}},
      {"pressure_dep_sliding",
       "",
       kOnForce,
       CandidateTerm::kSlider | CandidateTerm::kAxialLoad,
       {size("factor_at_50_MPa", 0.8), fixed("reference_pressure", 1), fixed("contact_area", 1)}},
      {"pressure_tanh_sliding",
       "",
       kOnForce,
       CandidateTerm::kSlider | CandidateTerm::kAxialLoad,
       {size("high_pressure_reduction", 0.3), shape("pressure_scale", 0.05, 20, {1}),
        fixed("contact_area", 1)}},
      {"rim_stop",
       "",
       kOnForce,
       CandidateTerm::kSlider,
       {size("stiffness", 2), shape("clearance", 0.2, 1, {0.7, 0.9})}},
      {"mer_spring",
       "",
       kOnForce,
       CandidateTerm::kSlider,
       {size("stiffness", 0.5), shape("gap", 0.01, 1, {0.2, 0.6})}},
      {"flat_slider",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad | CandidateTerm::kTwoAxes,
       {size("friction_coefficient", 1e-3), typical("initial_stiffness")}},
      {"horizontal_stiffness_variation",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad | CandidateTerm::kHysteresis | CandidateTerm::kBucklingLoad,
       {size("coefficient", 0.1)}},
      {"velocity_dep_sliding",
       "",
       kOnForce,
       CandidateTerm::kSlider,
       {size("low_velocity_reduction", 0.2), shape("rate", 2, 500, {20, 80})}},
      {"bouc_wen",
       "",
       kOnForce,
       CandidateTerm::kNoHysteresis,
       {size("characteristic_strength", 0.3), shape("yield_displacement", 1e-3, 1, {0.03, 0.2})}},
      {"asymmetric_hysteresis",
       "",
       kOnForce,
       CandidateTerm::kNoHysteresis,
       {size("forward_force", 0.3), size("backward_force", 0.3),
        shape("forward_length", 1e-4, 1, {0.03, 0.15}), shape("backward_length", 1e-4, 1, {0.03}),
        size("play", 0.1)}},
      {"current_dependent_friction",
       "",
       kOnForce,
       CandidateTerm::kAuxiliary,
       {size("friction_force", 0.1), size("force_per_current", 0.5),
        size("force_per_current2", 0.01), kPresliding, shape("creep_velocity", 1e-5, 1, {0.02})}},
      {"current_dependent_damping",
       "",
       kOnForce,
       CandidateTerm::kAuxiliary,
       {size("coefficient_per_current", 0.5), size("coefficient_per_current2", 0.01)}},
      {"control_lag",
       "",
       kOnForce,
       CandidateTerm::kAuxiliary | CandidateTerm::kControlledTerm,
       {size("time_constant", {0.003, 0.02, 0.1})}},
      {"control_delay",
       "",
       kOnForce,
       CandidateTerm::kAuxiliary | CandidateTerm::kControlledTerm,
       {size("delay", {0.003, 0.02})}},
  };
  return entries;
}

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<CandidateTerm>& machine_entries() {
  static const std::vector<CandidateTerm> entries{
      {"support_flexibility",
       "",
       kOnForce,
       CandidateTerm::kHidden,
       {size("flexibility", 0.01), fixed("stiffness_estimate", 5)}},
      {"mount_slack",
       "",
       kOnForce,
       0,
       {size("slack", {0.003, 0.013, 0.1}, 0, 1), fixed("seating_force", 0.007),
        fixed("stiffness_estimate", 5)}},
      {"transducer_backlash", "", kOnForce, 0, {size("gap", {0.003, 0.013, 0.1}, 0, 1)}},
      {"coulomb_friction",
       "",
       kOnForce,
       0,
       {size("friction_force", 0.004, kEachAxis), kPresliding}},
      {"planar_friction",
       "",
       kOnForce,
       CandidateTerm::kTwoAxes,
       {size("friction_force", 0.004), kPresliding}},
      {"asymmetric_friction",
       "",
       kOnForce,
       0,
       {size("forward_force", 0.004, kEachAxis), size("backward_force", 0.003, kEachAxis),
        kPresliding},
       {},
       {"coulomb_friction"}},
      {"load_dependent_friction",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad,
       {size("friction_coefficient", 1e-3), kPresliding}},
      {"stribeck_friction",
       "",
       kOnForce,
       0,
       {size("friction_force", 0.004, kEachAxis), size("breakaway_force", 0.004),
        shape("stribeck_velocity", 0.004, 0.6, {0.025, 0.1}), kPresliding},
       {},
       {"coulomb_friction"}},
      {"velocity_dependent_friction",
       "",
       kOnForce,
       0,
       {size("friction_force", 0.01, kEachAxis), shape("growth_velocity", 0.002, 5, {0.05, 0.5}),
        kPresliding},
       {},
       {"coulomb_friction"},
       kWaits},
      {"position_dependent_friction",
       "",
       kOnForce,
       0,
       {size("friction_force", 0.01), shape("place", -1, 1, {0.2, -0.2, 0}),
        shape("width", 0.02, 1, {0.15}), kPresliding}},
      {"viscous_friction", "", kOnForce, 0, {size("coefficient", 0.003, kEachAxis)}},
      {"asymmetric_viscous",
       "",
       kOnForce,
       0,
       {size("forward_coefficient", 0.004, kEachAxis),
        size("backward_coefficient", 0.002, kEachAxis)},
       {},
       {"viscous_friction"}},
      {"quadratic_drag", "", kOnForce, 0, {size("coefficient", 0.003)}},
      {"power_damping",
       "",
       kOnForce,
       0,
       {size("force", 0.003), shape("exponent", 0.1, 3, {0.4, 1.6}),
        fixed("reference_velocity", 1)},
       {},
       {"coulomb_friction", "viscous_friction", "quadratic_drag"},
       kWaits},
      {"gap_contact",
       "",
       kOnForce,
       0,
       {size("stiffness", 0.1), shape("gap", 0.05, 1, {0.5, 0.85})}},
      {"platen_inertia", "", kOnForce, 0, {size("mass", 0.02, kEachAxis)}},
  };
  return entries;
}

const std::vector<CandidateTerm>& sensor_entries() {
  static const std::vector<CandidateTerm> entries{
      {"offset", "", kOnForce, 0, {size("offset", 0.01, kEachAxis)}},
      {"drift", "", kOnForce, 0, {size("rate", 0.01, kEachAxis)}},
      {"gain", "", kOnForce, 0, {size("factor", 1.01, kEachAxis)}},
      {"saturation", "", kOnForce, 0, {size("limit", {0.985, 0.95, 0.88}, 0.3, 1.5)}},
      {"crosstalk_horizontal",
       "",
       kOnForce,
       CandidateTerm::kTwoAxes,
       {size("lat_into_long", 0.005), size("long_into_lat", 0.005)}},
      {"crosstalk_vertical",
       "",
       kOnForce,
       CandidateTerm::kAxialLoad,
       {size("share", 0.003, kEachAxis), fixed("reference_load", 1)}},
      {"time_skew", "", kOnForce, 0, {size("skew", 1e-3)}},
      {"clock_drift", "", kOnForce, 0, {size("skew", 1e-3), size("rate", 5e-5)}},
      {"filter_lag", "", kOnForce, 0, {size("time_constant", 1e-3)}},
      {"absolute_value_sensor", "", kOnForce, 0, {size("share", 0.01)}},

      {"gain", "", kOnAccelerometer, 0, {size("factor", 1.01, kEachAxis)}},
      {"drift", "", kOnAccelerometer, 0, {size("rate", 0.01, kEachAxis)}},
      {"accelerometer_tilt",
       "",
       kOnAccelerometer,
       0,
       {size("tilt_per_displacement", 0.01, kEachAxis)}},
      {"time_skew", "", kOnAccelerometer, 0, {size("skew", 1e-3)}},
      {"cubic_distortion", "", kOnAccelerometer, 0, {size("share", 0.01), fixed("range", 1)}},
  };
  return entries;
}

const std::vector<CandidateTerm>& actuator_entries() {
  static const std::vector<CandidateTerm> entries{
      {"actuator_delay", "", kOnActuator, 0, {size("delay", 4e-3)}},
      {"first_order_lag", "", kOnActuator, 0, {size("time_constant", 4e-3)}},
      {"actuator_bandwidth",
       "",
       kOnActuator,
       0,
       {size("time_constant", 6e-3), shape("damping", 0.05, 5, {0.8})}},
      {"oil_column_resonance",
       "",
       kOnActuator,
       0,
       {size("time_constant", {5.5e-3, 7e-3, 9e-3}), shape("damping", 0.02, 1, {0.1})}},
      {"actuator_bandwidth",
       "rate_saturation",
       kOnActuator,
       CandidateTerm::kKindInModel,
       {size("velocity_limit", {1, 0.98, 0.95}, 0.2, 2)},
       "largest velocity of the actuator"},
      {"actuator_bandwidth",
       "valve_deadband",
       kOnActuator,
       CandidateTerm::kKindInModel,
       {size("dead_band", {0.003, 0.01}, 0, 0.3)},
       "dead band of the servo valve"},
      {"rate_saturation",
       "",
       kOnActuator,
       CandidateTerm::kNoServoLoop,
       {size("velocity_limit", {1, 0.98, 0.95}, 0.2, 2)}},
      {"valve_deadband",
       "",
       kOnActuator,
       CandidateTerm::kNoServoLoop,
       {size("dead_band", {0.003, 0.01}, 0, 0.3), shape("time_constant", 1e-3, 0.1, {5e-3})}},
      {"load_compliance",
       "",
       kOnActuator,
       CandidateTerm::kLoadCell,
       {size("compliance", 0.01), shape("time_constant", 1e-4, 0.05, {2e-3}),
        fixed("stiffness_estimate", 0)}},
      {"gain", "", kOnActuator, 0, {size("factor", 1.01, kEachAxis)}},
  };
  return entries;
}

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

}  // namespace

std::span<const CandidateTerm> candidate_terms() {
  static const std::vector<CandidateTerm> all_entries = [] {
    std::vector<CandidateTerm> all;
    for (const auto* entries :
         {&bearing_entries(), &rule_and_device_entries(), &machine_entries(), &sensor_entries(),
          &actuator_entries(), &connection_entries(), &signal_entries()})
      all.insert(all.end(), entries->begin(), entries->end());
    return all;
  }();
  return all_entries;
}

std::span<const std::pair<std::string_view, std::string_view>> terms_not_searched() {
  constexpr std::string_view kVertical = "needs the vertical displacement, which is not recorded",
                             kTable = "imitates any law: fitted to describe an unknown effect",
                             kLoop = "another model of the whole specimen, not an added effect";
  static constexpr std::pair<std::string_view, std::string_view> kTerms[] = {
      {"buckling_load_variation", "acts only through terms that need the buckling load"},
      {"vertical_stiffness_variation", kVertical},
      {"elastomeric_axial", kVertical},
      {"pendulum_lift", kVertical},
      {"multilinear_axial", kVertical},
      {"lead_heating", "needs the dimensions of the lead core; adiabatic_heating is searched for"},
      {"viscous_damping", "is the same as viscous_friction"},
      {"bouc_wen_nagarajaiah", kLoop},
      {"bilinear", kLoop},
      {"iwan", kLoop},
      {"single_pendulum", kLoop},
      {"triple_pendulum", kLoop},
      {"polynomial_stiffness", "its powers are searched for one by one"},
      {"tabulated_stiffness", kTable},
      {"tabulated_damping", kTable},
      {"tabulated_viscosity", kTable},
      {"tabulated_friction", kTable},
      {"cogging", "fits many residuals; found as a form that is periodic in displacement"},
      {"quantisation", "found in the samples"}};
  return kTerms;
}

std::span<const std::pair<std::string_view, std::string_view>> terms_not_searched_freely() {
  constexpr std::string_view kAxial = "needs a vertical force, which no free model has",
                             kAxes = "joins two axes, which no connection has",
                             kBearing = "refines a bearing: searched for in compositions",
                             kControl = "needs the control signal of a device",
                             kMachine = "belongs to a test machine and its sensors";
  static constexpr std::pair<std::string_view, std::string_view> kTerms[] = {
      {"axial_load_strength", kAxial},
      {"axial_load_stiffness", kAxial},
      {"p_delta", kAxial},
      {"horizontal_stiffness_variation", kAxial},
      {"load_dependent_friction", kAxial},
      {"flat_slider", kAxial},
      {"pressure_dep_sliding", kAxial},
      {"pressure_tanh_sliding", kAxial},
      {"velocity_dep_sliding", kAxial},
      {"friction_heating", kAxial},
      {"crosstalk_vertical", kAxial},
      {"planar_friction", kAxes},
      {"crosstalk_horizontal", kAxes},
      {"adiabatic_heating", "is the same as degradation in one record"},
      {"ageing_temperature", kBearing},
      {"asymmetric_hysteresis", kBearing},
      {"bouc_wen_slip", kBearing},
      {"hysteresis_shape", kBearing},
      {"rate_dep_strength", kBearing},
      {"scragging", kBearing},
      {"mer_spring", kBearing},
      {"rim_stop", kBearing},
      {"control_delay", kControl},
      {"control_lag", kControl},
      {"current_dependent_damping", kControl},
      {"current_dependent_friction", kControl},
      {"accelerometer_tilt", kMachine},
      {"clock_drift", kMachine},
      {"load_compliance", kMachine},
      {"mount_slack", kMachine},
      {"oil_column_resonance", kMachine},
      {"support_flexibility", kMachine},
      {"valve_deadband", kMachine}};
  return kTerms;
}

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "candidate_tables.hpp"

namespace rths::diagnosis::candidate_tables {

const std::vector<CandidateTerm>& bearing_entries() {
  static const std::vector<CandidateTerm> entries{
      term("adiabatic_heating", kOnForce, kHysteresis,
           {size("softening", 0.01), shape("cooling_time", 0.5, 1e5, {100, 5}), kElasticShare}),
      term("axial_load_strength", kOnForce, kAxialLoad | kHysteresis,
           {size("coefficient", 0.05), fixed("reference_load", 1), kElasticShare}),
      term("axial_load_stiffness", kOnForce, kAxialLoad | kHysteresis,
           {size("coefficient", 0.02), fixed("reference_load", 1)}),
      term("p_delta", kOnForce, kAxialLoad, {size("coefficient", 0.003)}),
      named("bidirectional_coupling", "coupling of the axes",
            term("bouc_wen", kOnForce, kKindInModel | kTwoAxes, {size("coupling", 0.8)})),
      term("large_strain_stiffening", kOnForce,
           {size("stiffness", 0.05), shape("onset", 0.05, 1, {0.5, 0.75})}),
      term("linear_stiffness", kOnForce, {size("stiffness", 0.01)}),
      term("cubic_stiffness", kOnForce, {size("stiffness", 0.01)}),
      term("scragging", kOnForce, kHysteresis,
           {size("virgin_excess", 0.1), shape("scragging_displacement", 0.03, 4, {0.3, 0.8})}),
      term("rate_dep_strength", kOnForce, kHysteresis,
           {size("coefficient", 0.02), shape("reference_velocity", 1e-3, 1.5, {0.0125, 0.125}),
            kElasticShare}),
      term("viscoelastic_relaxation", kOnForce,
           {size("stiffness", 0.02), shape("relaxation_time", 0.01, 50, {1, 0.2, 0.04})}),
      named("second_relaxation", "a second Maxwell branch",
            term("viscoelastic_relaxation", kOnForce, kKindInModel | kBeside,
                 {size("stiffness", 0.02), shape("relaxation_time", 0.01, 50, {5, 0.05})})),
      term("asymmetric_stiffness", kOnForce, {size("stiffness", 0.01, kEachAxis)}),
      term("piecewise_stiffness", kOnForce, kNoHysteresis,
           {size("inside_stiffness", {0.3, 2}), shape("break_displacement", 0.02, 1, {0.2, 0.5})}),
      term("degradation", kOnForce, kHysteresis,
           {size("strength_loss", 0.02), size("stiffness_loss", 0.02), kElasticShare}),
      term("hysteresis_shape", kOnForce, kHysteresis | kCorrectsForm,
           {size("force_1", 0.002), size("force_2", 0.002), size("force_3", 0.002),
            size("force_4", 0.002), shape("length", 0.002, 0.05, {0.008})}),
  };
  return entries;
}

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<CandidateTerm>& rule_and_device_entries() {
  static const std::vector<CandidateTerm> entries{
      named("unloading_rule", "another unloading (beta)",
            term("bouc_wen", kOnForce, kRule | kKindInModel, {shape("beta", 0.01, 1, {0.2, 0.8})})),
      named("second_loop", "a second loop beside the first",
            term("bouc_wen", kOnForce, kRule | kBeside,
                 {size("characteristic_strength", 0.1),
                  shape("yield_displacement", 1e-3, 1, {0.3, 0.05}), shape("eta", 1, 6, {2})})),
      term("bouc_wen_slip", kOnForce, kRule | kInstead,
           {size("slip_length", 0.02), shape("slip_width", 0.05, 1, {0.2})}),
      term("ageing_temperature", kOnForce, kTemperature | kHysteresis,
           {size("stiffness_temperature", 0.004), size("strength_temperature", 0.004)}),
      term("friction_heating", kOnForce, kSlider,
           {size("heat_share", 0.5), shape("contact_area", 1e-6, 1e6, {1, 10, 0.1})}),
      term("pressure_dep_sliding", kOnForce, kSlider | kAxialLoad,
           {size("factor_at_50_MPa", 0.8), fixed("reference_pressure", 1),
            fixed("contact_area", 1)}),
      term("pressure_tanh_sliding", kOnForce, kSlider | kAxialLoad,
           {size("high_pressure_reduction", 0.3), shape("pressure_scale", 0.05, 20, {1}),
            fixed("contact_area", 1)}),
      term("rim_stop", kOnForce, kSlider,
           {size("stiffness", 2), shape("clearance", 0.2, 1, {0.7, 0.9})}),
      term("mer_spring", kOnForce, kSlider,
           {size("stiffness", 0.5), shape("gap", 0.01, 1, {0.2, 0.6})}),
      term("flat_slider", kOnForce, kAxialLoad | kTwoAxes,
           {size("friction_coefficient", 1e-3), typical("initial_stiffness")}),
      term("horizontal_stiffness_variation", kOnForce, kAxialLoad | kHysteresis | kBucklingLoad,
           {size("coefficient", 0.1)}),
      term("velocity_dep_sliding", kOnForce, kSlider,
           {size("low_velocity_reduction", 0.2), shape("rate", 2, 500, {20, 80})}),
      term("bouc_wen", kOnForce, kNoHysteresis,
           {size("characteristic_strength", 0.3), shape("yield_displacement", 1e-3, 1, {0.03, 0.2}),
            shape("eta", 1, 20, {2})}),
      term("asymmetric_hysteresis", kOnForce, kNoHysteresis,
           {size("forward_force", 0.3), size("backward_force", 0.3),
            shape("forward_length", 1e-4, 1, {0.03, 0.15}),
            shape("backward_length", 1e-4, 1, {0.03}), size("play", 0.1)}),
      term("current_dependent_friction", kOnForce, kAuxiliary,
           {size("friction_force", 0.1), size("force_per_current", 0.5),
            size("force_per_current2", 0.01), kPresliding,
            shape("creep_velocity", 1e-5, 1, {0.02})}),
      term("current_dependent_damping", kOnForce, kAuxiliary,
           {size("coefficient_per_current", 0.5), size("coefficient_per_current2", 0.01)}),
      term("control_lag", kOnForce, kAuxiliary | kControlledTerm,
           {size("time_constant", {0.003, 0.02, 0.1})}),
      term("control_delay", kOnForce, kAuxiliary | kControlledTerm, {size("delay", {0.003, 0.02})}),
  };
  return entries;
}

}  // namespace rths::diagnosis::candidate_tables

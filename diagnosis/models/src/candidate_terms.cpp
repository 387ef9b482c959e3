// SPDX-License-Identifier: Apache-2.0
#include "candidate_terms.hpp"

#include <algorithm>

#include "candidate_tables.hpp"
#include "unit_scales.hpp"

namespace rths::diagnosis {
namespace {

bool has_unit_of_time(const sim::Parameter& parameter) {
  const auto factors = factors_of(parameter.unit);
  return std::any_of(factors.begin(), factors.end(), [](const UnitFactor& factor) {
    return factor.symbol == "s" || factor.symbol == "kg" || factor.symbol == "W";
  });
}

}  // namespace

bool needs_time(const CandidateTerm& entry) {
  const auto& parameters = sim::term_kind(entry.kind).parameters;
  return std::any_of(parameters.begin(), parameters.end(), [&](const sim::Parameter& parameter) {
    if (!has_unit_of_time(parameter) || parameter.name == kCreepVelocity) return false;
    return parameter.absent != 0 ||
           std::any_of(entry.parameters.begin(), entry.parameters.end(),
                       [&](const auto& own) { return own.name == parameter.name; });
  });
}

bool needs_time(const sim::TermSettings& term) {
  const auto& parameters = sim::term_kind(term.kind).parameters;
  return std::any_of(parameters.begin(), parameters.end(), [&](const sim::Parameter& parameter) {
    double value = parameter.absent;
    for (const auto& [name, stated] : term.parameters)
      if (name == parameter.name) value = stated;
    return has_unit_of_time(parameter) && parameter.name != kCreepVelocity && value != 0;
  });
}

std::span<const CandidateTerm> candidate_terms() {
  using namespace candidate_tables;
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

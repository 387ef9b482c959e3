// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::sim {

/// Dimensions and materials of a round lead-rubber bearing. Without lead (`lead_diameter` 0) it is
/// a low-damping rubber bearing. Sources: Kumar, Whittaker & Constantinou (2014) for the derived
/// quantities and for the defaults of cavitation; Kalpakidis & Constantinou (2009) for the defaults
/// of lead and steel.
struct LeadRubberDesign {
  double outer_diameter = 0;   ///< of the rubber within the cover, D_2 [m]
  double lead_diameter = 0;    ///< of the plug, D_1 [m]
  double cover = 0;            ///< added to the outer diameter for areas, t_c [m]
  int rubber_layers = 0;       ///< n
  double layer_thickness = 0;  ///< of one rubber layer, t_r [m]
  double shim_thickness = 0;   ///< of one steel shim, t_s [m]
  double shear_modulus = 0;    ///< of rubber, G [Pa]
  double bulk_modulus = 2e9;   ///< of rubber, K [Pa]

  double characteristic_strength = 0;  ///< Q_d [N]
  double stiffness_ratio = 0.1;        ///< stiffness after yield over initial stiffness, α [-]
  double horizontal_damping = 0;       ///< c_d [N·s/m]

  double post_cavitation_decay = 10;  ///< k_c [1/m]
  double cavitation_damage = 0.5;     ///< largest fraction of F_c lost to cavitation, Φ [-]
  double damage_rate = 1;             ///< a_c [-]

  double lead_density = 11200;         ///< [kg/m³]
  double lead_specific_heat = 130;     ///< [J/kg/K]
  double steel_conductivity = 50;      ///< [W/m/K]
  double steel_diffusivity = 1.41e-5;  ///< [m²/s]
  double softening = 0.0069;           ///< of lead with temperature [1/K]
};

// Quantities derived from a design: docs/theory/lead_rubber.md, "Design".
[[nodiscard]] double rubber_area(const LeadRubberDesign&);       ///< bonded, A [m²]
[[nodiscard]] double lead_area(const LeadRubberDesign&);         ///< A_L [m²]
[[nodiscard]] double shape_factor(const LeadRubberDesign&);      ///< loaded over free area, S [-]
[[nodiscard]] double rubber_thickness(const LeadRubberDesign&);  ///< of all layers, T_r [m]
[[nodiscard]] double height(const LeadRubberDesign&);            ///< rubber and shims, h [m]
[[nodiscard]] double hole_factor(const LeadRubberDesign&);       ///< F; 1 without a hole [-]
[[nodiscard]] double compression_modulus(const LeadRubberDesign&);  ///< E_c [Pa]
[[nodiscard]] double rotation_modulus(const LeadRubberDesign&);     ///< E_r [Pa]
[[nodiscard]] double moment_of_inertia(const LeadRubberDesign&);    ///< I [m⁴]
[[nodiscard]] double radius_of_gyration(const LeadRubberDesign&);   ///< r_g [m]

[[nodiscard]] double vertical_stiffness(const LeadRubberDesign&);    ///< undisplaced, K_v0 [N/m]
[[nodiscard]] double post_yield_stiffness(const LeadRubberDesign&);  ///< K_d [N/m]
[[nodiscard]] double initial_stiffness(const LeadRubberDesign&);     ///< K_d/α [N/m]
[[nodiscard]] double yield_displacement(const LeadRubberDesign&);    ///< u_y [m]
[[nodiscard]] double torsional_stiffness(const LeadRubberDesign&);   ///< K_t [N·m/rad]
[[nodiscard]] double rotational_stiffness(const LeadRubberDesign&);  ///< K_r [N·m/rad]

[[nodiscard]] double euler_load(const LeadRubberDesign&);        ///< P_e [N]
[[nodiscard]] double critical_load(const LeadRubberDesign&);     ///< undisplaced, > 0, P_cr0 [N]
[[nodiscard]] double cavitation_force(const LeadRubberDesign&);  ///< > 0, F_c [N]

/// Effects to include, besides hysteresis and the linear axial law.
struct LeadRubberEffects {
  bool cavitation = true;                      ///< with damage
  bool buckling_load_variation = true;         ///< with displacement; false: constant
  bool horizontal_stiffness_variation = true;  ///< with the axial load
  bool vertical_stiffness_variation = true;    ///< with displacement
  bool lead_heating = true;
};

/// The bearing as terms, which need the vertical displacement as an input.
/// @throws Error if a dimension or modulus is not positive, or the plug fills the bearing   @setup
[[nodiscard]] std::vector<TermSettings> terms_of(const LeadRubberDesign& design,
                                                 const LeadRubberEffects& effects = {});

}  // namespace rths::sim

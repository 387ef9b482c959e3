// SPDX-License-Identifier: Apache-2.0
#include "effects.hpp"

// Effects that were not in the library of the diagnosis when these trials began. The last argument
// names a later term that describes the effect.
namespace trial {
namespace {

Effect outside(std::string_view part, std::string_view name, std::string_view form,
               std::vector<Draw> draws, std::string_view kin = "") {
  return {name, part, "force", Relation::Force, std::move(draws), Home::Outside, form, kin};
}

}  // namespace

std::vector<Effect> outside_effects() {
  const Draw presliding{kPresliding, 1e-4, 6e-4};
  return {
      outside("machine", "cogging", "periodic in displacement",
              {{kCogging, 5e3, 15e3, kSize}, {kCoggingPitch, 0.012, 0.03}, {kCoggingPhase, 0, 6}},
              "cogging"),
      outside("machine", "local_rub", "sgn(v) g(u)",
              {{kPatch, 12e3, 35e3, kSize},
               {kPatchPlace, 0.01, 0.06, false, kEitherSign},
               {kPatchWidth, 0.008, 0.02},
               presliding},
              "position_dependent_friction"),
      outside("bearing", "damage_step", "change of strength at a time",
              {{kDamage, 0.03, 0.08, kSize}, {kDamageTime, 8, 14}}),
      outside("machine", "one_sided_damping", "f(v)",
              {{kOneSidedX, 20e3, 60e3, kSize}, {kOneSidedY, 20e3, 60e3, kSize}},
              "asymmetric_viscous"),
      outside("machine", "pump_ripple", "external periodic force",
              {{kRipple, 3e3, 12e3, kSize}, {kRippleFrequency, 4, 12}, {kRipplePhase, 0, 6}}),
      outside("machine", "cross_axis_ratchet", "f(v_long v_lat)",
              {{kRatchet, 5e3, 20e3, kSize, kEitherSign}, {kRatchetVelocity, 0.05, 0.2}}),
      outside("machine", "gyroscopic", "f(v of the other axis)",
              {{kGyroscopic, 15e3, 50e3, kSize, kEitherSign}}),
      outside("machine", "wearing_guide", "sgn(v) g(path)", {{kWear, 2e3, 8e3, kSize}, presliding}),
      outside("machine", "corner_contact", "f(u_long, u_lat)",
              {{kCorner, 8e5, 3e6, kSize},
               {kCornerPlace, 0.003, 0.015},
               {kCornerSide, 1, 1, false, kEitherSign}}),
      outside("sensor", "dropout", "held samples", {{kDropout, 0.01, 0.03, kSize}}),
  };
}

}  // namespace trial

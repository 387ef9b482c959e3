// SPDX-License-Identifier: Apache-2.0
#include "effects.hpp"

namespace trial {
namespace {

constexpr bool kSize = true;
constexpr bool kEitherSign = true;

}  // namespace

std::vector<Effect> force_sensor_effects() {
  const auto load_cell = [](std::string_view name, std::vector<Draw> draws) {
    return Effect{name, "sensor", "force", Relation::Force, std::move(draws)};
  };
  return {
      load_cell("loadcell_drift", {{kDriftX, 8e3, 30e3, kSize, kEitherSign},
                                   {kDriftY, 8e3, 30e3, kSize, kEitherSign}}),
      load_cell("loadcell_gain", {{kGainX, 0.005, 0.03, kSize, kEitherSign},
                                  {kGainY, 0.005, 0.03, kSize, kEitherSign}}),
      load_cell("loadcell_saturation", {{kClipShare, 0.04, 0.14, kSize}}),
      load_cell("crosstalk_horizontal", {{kCrossXY, 0.006, 0.02, kSize, kEitherSign},
                                         {kCrossYX, 0.006, 0.02, kSize, kEitherSign}}),
      load_cell("crosstalk_vertical", {{kVerticalX, 0.002, 0.008, kSize, kEitherSign},
                                       {kVerticalY, 0.002, 0.008, kSize, kEitherSign}}),
      load_cell("force_time_skew", {{kSkew, 1e-3, 5e-3, kSize}}),
      load_cell("clock_drift", {{kClock, 60e-6, 200e-6, kSize}}),
      load_cell("filter_lag", {{kLag, 1e-3, 4e-3, kSize}}),
      load_cell("absolute_value_sensor", {{kAbsolute, 0.01, 0.05, kSize}}),
      load_cell("quantisation", {{kForceStep, 8e3, 30e3, kSize}}),
  };
}

std::vector<Effect> other_sensor_effects() {
  const auto accelerometer = [](std::string_view name, std::vector<Draw> draws) {
    return Effect{name, "sensor", "acceleration", Relation::Kinematic, std::move(draws)};
  };
  return {
      accelerometer("accelerometer_tilt", {{kTiltX, 0.01, 0.05, kSize, kEitherSign},
                                           {kTiltY, 0.01, 0.05, kSize, kEitherSign}}),
      accelerometer("accelerometer_gain", {{kAccelerationGainX, 0.005, 0.03, kSize, kEitherSign},
                                           {kAccelerationGainY, 0.005, 0.03, kSize, kEitherSign}}),
      accelerometer("accelerometer_drift", {{kAccelerationDriftX, 0.03, 0.15, kSize, kEitherSign},
                                            {kAccelerationDriftY, 0.03, 0.15, kSize, kEitherSign}}),
  };
}

// Nothing of this is in the library of the diagnosis; should it have come in, `kin` names the term.
std::vector<Effect> outside_effects() {
  std::vector<Effect> all;
  const auto outside = [&](std::string_view name, std::string_view form, std::vector<Draw> draws,
                           std::string_view kin = "") {
    const bool senses = name == "dropout";
    all.push_back({name, senses ? "sensor" : "machine", "force", Relation::Force, std::move(draws),
                   Home::Outside, form, kin});
  };
  outside("cogging", "periodic in displacement",
          {{kCogging, 5e3, 15e3, kSize}, {kCoggingPitch, 0.012, 0.03}, {kCoggingPhase, 0, 6}},
          "cogging");
  outside("local_rub", "sgn(v) g(u)",
          {{kPatch, 12e3, 35e3, kSize},
           {kPatchPlace, 0.01, 0.06, false, kEitherSign},
           {kPatchWidth, 0.008, 0.02}},
          "position_dependent_friction");
  outside("damage_step", "change of strength at a time",
          {{kDamage, 0.03, 0.08, kSize}, {kDamageTime, 8, 14}});
  outside("one_sided_damping", "f(v)",
          {{kOneSidedX, 20e3, 60e3, kSize}, {kOneSidedY, 20e3, 60e3, kSize}}, "asymmetric_viscous");
  outside("pump_ripple", "external periodic force",
          {{kRipple, 3e3, 12e3, kSize}, {kRippleFrequency, 4, 12}, {kRipplePhase, 0, 6}});
  outside("cross_axis_ratchet", "f(v_long v_lat)",
          {{kRatchet, 5e3, 20e3, kSize, kEitherSign}, {kRatchetVelocity, 0.05, 0.2}});
  outside("gyroscopic", "f(v of the other axis)", {{kGyroscopic, 15e3, 50e3, kSize, kEitherSign}});
  outside("dropout", "held samples", {{kDropout, 0.01, 0.03, kSize}});
  return all;
}

}  // namespace trial

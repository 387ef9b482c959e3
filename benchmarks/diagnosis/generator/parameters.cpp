// SPDX-License-Identifier: Apache-2.0
#include "parameters.hpp"

namespace trial {
namespace {

constexpr double kAny = 1e30;

constexpr ParameterInfo kTable[] = {
    {kStiffness, "post_yield_stiffness", "N/m", 4.238e6, 1e5, 5e5, 2e7},
    {kStrength, "characteristic_strength", "N", 1.01e6, 2e4, 5e4, 5e6},
    {kYieldDisplacement, "yield_displacement", "m", 0.018, 1e-3, 4e-3, 0.06},
    {kExponent, "exponent", "-", 2, 0.1, 1, 4},
    {kBeta, "beta", "-", 0.5, 0.05, 0, 1},
    {kMixShare, "share_of_second_loop", "-", 0, 0.05, 0, 1},
    {kMixRatio, "yield_displacement_ratio", "-", 4, 0.5, 1, 20},
    {kCoupling, "coupling", "-", 1, 0.05, 0, 1.6},
    {kHeating, "heating", "1/m", 0, 0.02, 0, 3},
    {kCooling, "cooling", "1/s", 0.01, 0.01, 0, 5},
    {kAxialStrength, "axial_strength", "-", 0, 0.02, -1, 1},
    {kAxialStiffness, "axial_stiffness", "-", 0, 0.01, -1, 1},
    {kPDelta, "p_delta", "1/m", 0, 5e-3, -1, 1},
    {kStiffening, "stiffening", "N/m", 0, 2e5, 0, 1e8},
    {kStiffeningOnset, "stiffening_onset", "m", 0.1, 0.01, 0, 0.3},
    {kCubic, "cubic", "N/m3", 0, 3e6, -1e9, 1e9},
    {kScragging, "scragging", "-", 0, 0.03, 0, 3},
    {kScraggingLength, "scragging_displacement", "m", 0.05, 0.01, 5e-3, 0.6},
    {kRate, "rate", "-", 0, 0.01, 0, 0.5},
    {kRateVelocity, "rate_velocity", "m/s", 0.02, 5e-3, 5e-4, 1},
    {kMaxwell, "branch_stiffness", "N/m", 0, 5e4, 0, 1e7},
    {kMaxwellRate, "branch_rate", "1/s", 1, 0.2, 0.02, 200},
    {kQuadraticX, "quadratic_long", "N/m2", 0, 2e5, -kAny, kAny},
    {kQuadraticY, "quadratic_lat", "N/m2", 0, 2e5, -kAny, kAny},
    {kShape1, "force_at_1.2_mm", "N", 0, 3e3, -kAny, kAny},
    {kShape2, "force_at_4_mm", "N", 0, 3e3, -kAny, kAny},
    {kShape3, "force_at_13_mm", "N", 0, 3e3, -kAny, kAny},
    {kShape4, "force_at_45_mm", "N", 0, 3e3, -kAny, kAny},
    {kMassErrorX, "mass_error_long", "-", 0, 0.01, -0.5, 0.5},
    {kMassErrorY, "mass_error_lat", "-", 0, 0.01, -0.5, 0.5},
    {kFrictionX, "friction_long", "N", 0, 2e3, 0, kAny},
    {kFrictionY, "friction_lat", "N", 0, 2e3, 0, kAny},
    {kPresliding, "presliding", "m", 3e-4, 5e-5, 2e-5, 2e-3},
    {kAsymmetryX, "forward_minus_mean_long", "N", 0, 2e3, -kAny, kAny},
    {kAsymmetryY, "forward_minus_mean_lat", "N", 0, 2e3, -kAny, kAny},
    {kRub, "rub_force", "N", 0, 2e3, 0, kAny},
    {kRubPlace, "rub_place", "m", 0.03, 5e-3, -0.2, 0.2},
    {kRubWidth, "rub_width", "m", 0.03, 5e-3, 2e-3, 0.2},
    {kViscousX, "viscous_long", "N*s/m", 0, 2e3, 0, kAny},
    {kViscousY, "viscous_lat", "N*s/m", 0, 2e3, 0, kAny},
    {kDrag, "drag", "N*s2/m2", 0, 2e3, 0, kAny},
    {kLoadFriction, "friction_coefficient", "-", 0, 3e-4, 0, 1},
    {kBreakaway, "breakaway_force", "N", 0, 2e3, 0, kAny},
    {kStribeckVelocity, "stribeck_velocity", "m/s", 0.03, 5e-3, 3e-3, 0.3},
    {kFlexibility, "flexibility", "m/N", 0, 2e-10, 0, 1e-8},
    {kBacklash, "gap", "m", 0, 2e-4, 0, 0.05},
    {kSlack, "slack", "m", 0, 2e-4, 0, 0.05},
    {kOffsetX, "force_offset_long", "N", 0, 1e3, -kAny, kAny},
    {kOffsetY, "force_offset_lat", "N", 0, 1e3, -kAny, kAny},
    {kDriftX, "drift_long", "N", 0, 1e3, -kAny, kAny},
    {kDriftY, "drift_lat", "N", 0, 1e3, -kAny, kAny},
    {kGainX, "gain_error_long", "-", 0, 5e-3, -0.5, 0.5},
    {kGainY, "gain_error_lat", "-", 0, 5e-3, -0.5, 0.5},
    {kClipShare, "share_of_peak_cut", "-", 0, 0.01, 0, 0.9},
    {kClipLimit, "limit", "N", kAny, 1e4, 1e5, kAny},
    {kCrossXY, "lat_into_long", "-", 0, 2e-3, -1, 1},
    {kCrossYX, "long_into_lat", "-", 0, 2e-3, -1, 1},
    {kVerticalX, "vertical_into_long", "-", 0, 1e-3, -1, 1},
    {kVerticalY, "vertical_into_lat", "-", 0, 1e-3, -1, 1},
    {kSkew, "skew", "s", 0, 5e-4, 0, 0.05},
    {kClock, "clock_rate", "-", 0, 2e-5, 0, 0.01},
    {kLag, "lag", "s", 0, 5e-4, 0, 0.05},
    {kAbsolute, "rectified_share", "-", 0, 0.01, 0, 1},
    {kForceStep, "force_step", "N", 0, 1e3, 0, 1e6},
    {kDisplacementStep, "displacement_step", "m", 0, 1e-4, 0, 0.1},
    {kAccelerationStep, "acceleration_step", "m/s2", 0, 1e-2, 0, 10},
    {kTiltX, "tilt_long", "rad/m", 0, 0.01, -1, 1},
    {kTiltY, "tilt_lat", "rad/m", 0, 0.01, -1, 1},
    {kAccelerationGainX, "acceleration_gain_error_long", "-", 0, 5e-3, -1, 1},
    {kAccelerationGainY, "acceleration_gain_error_lat", "-", 0, 5e-3, -1, 1},
    {kAccelerationDriftX, "acceleration_drift_long", "m/s2", 0, 0.01, -10, 10},
    {kAccelerationDriftY, "acceleration_drift_lat", "m/s2", 0, 0.01, -10, 10},
    {kAccelerationOffsetX, "acceleration_offset_long", "m/s2", 0, 0.01, -10, 10},
    {kAccelerationOffsetY, "acceleration_offset_lat", "m/s2", 0, 0.01, -10, 10},
    {kExtraDelay, "extra_delay", "s", 0, 5e-4, 0, 0.02},
    {kBandwidth, "bandwidth_factor", "-", 1, 0.02, 0.3, 3},
    {kSpeedShare, "share_of_peak_cut", "-", 0, 0.02, 0, 0.9},
    {kSpeedLimit, "speed_limit", "m/s", kAny, 0.05, 0.02, kAny},
    {kDeadBand, "dead_band", "m", 0, 2e-4, 0, 0.02},
    {kOilTime, "oil_time_constant", "s", 0, 5e-4, 0, 0.03},
    {kOilDamping, "oil_damping", "-", 0.1, 0.02, 0.01, 1},
    {kCompliance, "compliance", "m/N", 0, 2e-10, 0, 1e-8},
    {kCogging, "cogging_force", "N", 0, 2e3, 0, kAny},
    {kCoggingPitch, "cogging_pitch", "m", 0.02, 1e-3, 2e-3, 0.2},
    {kCoggingPhase, "cogging_phase", "rad", 0, 0.2, -10, 10},
    {kPatch, "patch_force", "N", 0, 2e3, 0, kAny},
    {kPatchPlace, "patch_place", "m", 0.03, 5e-3, -0.2, 0.2},
    {kPatchWidth, "patch_half_width", "m", 0.02, 5e-3, 2e-3, 0.2},
    {kDamage, "share_of_strength_lost", "-", 0, 0.01, 0, 1},
    {kDamageTime, "damage_time", "s", 10, 0.2, 0, 40},
    {kOneSidedX, "one_sided_damping_long", "N*s/m", 0, 2e3, 0, kAny},
    {kOneSidedY, "one_sided_damping_lat", "N*s/m", 0, 2e3, 0, kAny},
    {kRipple, "ripple_force", "N", 0, 1e3, 0, kAny},
    {kRippleFrequency, "ripple_frequency", "Hz", 8, 0.002, 1, 25},
    {kRipplePhase, "ripple_phase", "rad", 0, 0.2, -10, 10},
    {kRatchet, "ratchet_force", "N", 0, 2e3, -kAny, kAny},
    {kRatchetVelocity, "ratchet_velocity", "m/s", 0.1, 0.02, 5e-3, 1},
    {kGyroscopic, "gyroscopic_damping", "N*s/m", 0, 2e3, -kAny, kAny},
    {kWear, "friction_per_path", "N/m", 0, 200, 0, kAny},
    {kCorner, "corner_stiffness", "N/m", 0, 1e5, 0, kAny},
    {kCornerPlace, "corner_place", "m", 0.01, 2e-3, 0, 0.2},
    {kCornerSide, "corner_side", "-", 1, 1, -1, 1},
    {kDropout, "held_time", "s", 0, 0.01, 0, 1},
};

constexpr bool in_order() {
  std::size_t next = 0;
  for (const ParameterInfo& entry : kTable)
    if (entry.parameter != next++) return false;
  return next == kParameterCount;
}
static_assert(in_order(), "the table follows the enumeration");

}  // namespace

const ParameterInfo& info(Parameter parameter) { return kTable[parameter]; }

Physics absent() {
  Physics physics{};
  for (const ParameterInfo& entry : kTable) physics[entry.parameter] = entry.absent;
  return physics;
}

}  // namespace trial

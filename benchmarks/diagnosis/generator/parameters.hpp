// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace trial {

/// The parameters of the synthetic laboratory's physics. Parameters of an absent effect have their
/// value `absent`.
enum Parameter : std::size_t {
  // bearing
  kStiffness,
  kStrength,
  kYieldDisplacement,
  kExponent,
  kBeta,
  kMixShare,
  kMixRatio,
  kCoupling,
  kHeating,
  kCooling,
  kAxialStrength,
  kAxialStiffness,
  kPDelta,
  kStiffening,
  kStiffeningOnset,
  kCubic,
  kScragging,
  kScraggingLength,
  kRate,
  kRateVelocity,
  kMaxwell,
  kMaxwellRate,
  kQuadraticX,
  kQuadraticY,
  kShape1,
  kShape2,
  kShape3,
  kShape4,
  // machine
  kMassErrorX,
  kMassErrorY,
  kFrictionX,
  kFrictionY,
  kPresliding,
  kAsymmetryX,
  kAsymmetryY,
  kRub,
  kRubPlace,
  kRubWidth,
  kViscousX,
  kViscousY,
  kDrag,
  kLoadFriction,
  kBreakaway,
  kStribeckVelocity,
  kFlexibility,
  kBacklash,
  kSlack,
  // sensors
  kOffsetX,
  kOffsetY,
  kDriftX,
  kDriftY,
  kGainX,
  kGainY,
  kClipShare,
  kClipLimit,
  kCrossXY,
  kCrossYX,
  kVerticalX,
  kVerticalY,
  kSkew,
  kClock,
  kLag,
  kAbsolute,
  kForceStep,
  kDisplacementStep,
  kAccelerationStep,
  kTiltX,
  kTiltY,
  kAccelerationGainX,
  kAccelerationGainY,
  kAccelerationDriftX,
  kAccelerationDriftY,
  kAccelerationOffsetX,
  kAccelerationOffsetY,
  // actuator
  kExtraDelay,
  kBandwidth,
  kSpeedShare,
  kSpeedLimit,
  kDeadBand,
  kOilTime,
  kOilDamping,
  kCompliance,
  // outside the library
  kCogging,
  kCoggingPitch,
  kCoggingPhase,
  kPatch,
  kPatchPlace,
  kPatchWidth,
  kDamage,
  kDamageTime,
  kOneSidedX,
  kOneSidedY,
  kRipple,
  kRippleFrequency,
  kRipplePhase,
  kRatchet,
  kRatchetVelocity,
  kGyroscopic,
  kWear,
  kCorner,
  kCornerPlace,
  kCornerSide,
  kDropout,
  kParameterCount
};

struct ParameterInfo {
  Parameter parameter;
  std::string_view name, unit;
  double absent;     ///< value without the effect; for a shape parameter, its default
  double step;       ///< for difference quotients
  double low, high;  ///< bounds of a fit
};

const ParameterInfo& info(Parameter parameter);

/// Values of all parameters, in SI.
using Physics = std::array<double, kParameterCount>;

Physics absent();

inline constexpr double kStandardGravity = 9.80665;  ///< [m/s²], CGPM 1901
inline constexpr double kReferenceLoad = 8e6;        ///< N_0, axial load at rest [N]
inline constexpr std::array<double, 2> kPlatenMass{113.3e3, 116.8e3};  ///< long, lat [kg]
inline constexpr double kRecordLength = 40;                            ///< [s]
inline constexpr double kQuietTime = 2;         ///< rest before the motion starts [s]
inline constexpr double kSampleTime = 1e-3;     ///< [s]
inline constexpr std::size_t kSubsteps = 10;    ///< internal, per sample
inline constexpr std::size_t kSamples = 40000;  ///< of one record

/// Nominal actuator, as the compensator assumes it.
inline constexpr double kTransportDelay = 4e-3;   ///< [s]
inline constexpr double kActuatorFrequency = 12;  ///< [Hz]
inline constexpr double kActuatorDamping = 0.85;  ///< [-]

}  // namespace trial

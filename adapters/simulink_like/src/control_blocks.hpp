// SPDX-License-Identifier: Apache-2.0
//
// The blocks of a hybrid controller, which wrap the classes of the controller folder. Their ports
// and parameters have the names of the diagram.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/ats.hpp>
#include <rths/controller/feed_forward.hpp>
#include <rths/controller/force_observer.hpp>
#include <rths/controller/lag_correction.hpp>
#include <rths/controller/path_sampler.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/table_force.hpp>
#include <rths/controller/target_exchange.hpp>
#include <rths/controller/target_force.hpp>
#include <rths/controller/vertical_force.hpp>
#include <rths/core/realtime.hpp>

namespace rths::adapters {

/// Pointers to a block's values: inputs, outputs and parameters in the order of its type's
/// declaration. A per-axis port points to the first of `axes` values.
struct Wires {
  std::vector<const double*> in;
  std::vector<double*> out;
  std::vector<const double*> parameter;
  std::size_t axes = 0;
  double time = 0;         ///< of the step [s]
  bool is_missed = false;  ///< the step is made after its time
};

/// Index of the input, output or parameter of a block that has one.
inline constexpr std::size_t kOnly = 0;

/// Predictor-corrector with the handshake and the sample-and-hold of the feedbacks.
struct PredictorCorrectorBlock {
  struct In {
    enum : std::size_t {
      kNewTarget,
      kTarget,
      kDisplacement,
      kForce,
      kTargetVelocity,
      kTargetAcceleration,
      kCount
    };
  };
  struct Out {
    enum : std::size_t {
      kCommand,
      kVelocity,
      kAcceleration,
      kHeldDisplacement,
      kHeldForce,
      kAtTarget,
      kSwitchPc,
      kState,
      kCounter,
      kStopped,
      kCorrectTime,
      kPredictTime,
      kSlowDownTime,
      kTargets,
      kTargetTime,
      kLostTime,
      kCount
    };
  };

  PredictorCorrectorBlock(const controller::PredictorCorrectorSettings& settings,
                          std::vector<int> delay_substeps, double substep_period);
  void step(const Wires& w) RTHS_REALTIME;

 private:
  void count(const Wires& w, bool new_target) noexcept;

  controller::PredictorCorrector command_;
  controller::TargetExchange exchange_;
  double period_;  ///< of a substep [s]
  controller::Target target_;
  Eigen::VectorXd displacement_, force_;
  double time_in_[3] = {0, 0, 0};  ///< Correct, Predict, AutoSlowDown since the last new target [s]
};

/// A smooth switch for the machine: fades between off and on within half a second.
struct Fade {
  double step;        ///< per sample
  double share = -1;  ///< 0 off, 1 on; negative before the first sample
  /// @returns the share after this sample   @realtime
  double operator()(bool on) RTHS_REALTIME;
};

/// An adaptive time series compensator per axis.
struct AtsBlock {
  struct In {
    enum : std::size_t { kCommand, kVelocity, kAcceleration, kMeasured, kCount };
  };
  struct Out {
    enum : std::size_t { kReference, kA0, kA1, kA2, kLimited, kCount };
  };
  struct Parameter {
    enum : std::size_t { kEnabled, kAdapt };
  };

  std::vector<controller::Ats> compensators;
  Fade fade;
  void step(const Wires& w) RTHS_REALTIME;
};

/// An adaptive inverse compensator per axis.
struct AdaptiveInverseBlock {
  struct In {
    enum : std::size_t { kCommand, kMeasured, kForce, kLostTime, kIsForceAhead, kCount };
  };
  struct Out {
    enum : std::size_t {
      kReference,
      kA0,
      kA1,
      kA2,
      kA3,
      kLoad,
      kLoadRate,
      kDeadBand,
      kFlowLoss,
      kLearning,
      kClipped,
      kBadSamples,
      kCount
    };
  };
  struct Parameter {
    enum : std::size_t { kEnabled, kAdapt };
  };

  std::vector<controller::AdaptiveInverse> compensators;
  Fade fade;
  double period;  ///< [s]
  controller::PaceMeter pace = {};
  void step(const Wires& w) RTHS_REALTIME;
};

/// Fixed lead from the command's rates.
struct FeedForwardBlock {
  struct In {
    enum : std::size_t { kReference, kVelocity, kAcceleration, kCount };
  };
  struct Out {
    enum : std::size_t { kReference, kCount };
  };
  struct Parameter {
    enum : std::size_t { kEnabled, kVelocityGain, kAccelerationGain };
  };

  Fade fade;
  void step(const Wires& w) RTHS_REALTIME;
};

/// Subtracts the machine's own force from the measured force, per axis.
struct ForceObserverBlock {
  struct In {
    enum : std::size_t { kDisplacement, kAcceleration, kForce, kCount };
  };
  struct Out {
    enum : std::size_t { kForce, kVelocity, kMachineForce, kCount };
  };
  struct Parameter {
    enum : std::size_t { kEnabled };
  };

  std::vector<controller::ForceObserver> observers;
  void step(const Wires& w) RTHS_REALTIME;
};

/// The same with load-dependent and presliding friction and a late accelerometer, per axis.
struct TableForceObserverBlock {
  struct In {
    enum : std::size_t { kDisplacement, kAcceleration, kForce, kAxialLoad, kCount };
  };
  struct Out {
    enum : std::size_t { kForce, kVelocity, kMachineForce, kBadSamples, kDisplacement, kCount };
  };
  struct Parameter {
    enum : std::size_t { kEnabled };
  };

  std::vector<controller::TableForceObserver> observers;
  void step(const Wires& w) RTHS_REALTIME;
};

/// Corrects the specimen's force for the tracking error.
struct TargetForceBlock {
  struct In {
    enum : std::size_t {
      kTarget,
      kDisplacement,
      kAcceleration,
      kForce,
      kCommand,
      kCommandVelocity,
      kCommandAcceleration,
      kAxialLoad,
      kCount
    };
  };
  struct Out {
    enum : std::size_t {
      kForce,
      kCorrection,
      kStrength,
      kLearning,
      kBadSamples,
      kAhead,
      kIsAhead,
      kCount
    };
  };
  struct Parameter {
    enum : std::size_t { kEnabled, kAdapt };
  };

  controller::TargetForce force;
  Fade fade;
  bool leads;       ///< false: the force ahead is the measured one
  bool knows_load;  ///< false: the specimen bears its load at rest
  void step(const Wires& w) RTHS_REALTIME;
};

/// Vertical force by lead or cascade. The reference is relative to that of the first target, under
/// which the specimen stands at the start.
struct VerticalForceBlock {
  struct In {
    enum : std::size_t { kTarget, kMeasured, kHorizontalTarget, kHorizontal, kLostTime, kCount };
  };
  struct Out {
    enum : std::size_t {
      kReference,
      kDisturbance,
      kA0,
      kA1,
      kLearning,
      kClipped,
      kBadSamples,
      kCount
    };
  };
  struct Parameter {
    enum : std::size_t { kAdapt };
  };

  controller::VerticalForceControl lead;
  controller::ForceCascade cascade;
  bool is_cascade;
  double limit;                                ///< of the reference ± [m]
  double period;                               ///< [s]
  std::optional<double> first = std::nullopt;  ///< reference [m]
  controller::PaceMeter pace = {};
  void step(const Wires& w) RTHS_REALTIME;
};

/// Measured force without gain and lag behind its command.
struct LagCorrectionBlock {
  struct In {
    enum : std::size_t { kCommand, kMeasured, kCount };
  };
  struct Out {
    enum : std::size_t { kForce, kGain, kLag, kCount };
  };
  struct Parameter {
    enum : std::size_t { kEnabled, kAdapt };
  };

  controller::LagCorrection correction;
  Fade fade;
  void step(const Wires& w) RTHS_REALTIME;
};

}  // namespace rths::adapters

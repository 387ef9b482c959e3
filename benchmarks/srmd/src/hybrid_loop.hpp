// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rths/core/config.hpp>
#include <rths/loop/force_feedback.hpp>
#include <rths/loop/numerical_response.hpp>
#include <rths/sim/machine/platen_run.hpp>

namespace rths::bench {

inline constexpr double kPeriod = 1e-3;  ///< of controller and machine [s]

/// Command of one axis and its rates, as the predictor-corrector gives them.
using AxisCommand = Eigen::Vector3d;  ///< x [m], ẋ [m/s], ẍ [m/s²]

/// The compensation of one axis: reference of the machine from command and measurement.
class Compensator {
 public:
  Compensator() = default;
  Compensator(const Compensator&) = delete;
  Compensator& operator=(const Compensator&) = delete;
  virtual ~Compensator() = default;
  /// @param measured  displacement of this sample [m]   @param force  of the specimen [N]
  /// @returns the reference [m]
  [[nodiscard]] virtual double step(const AxisCommand& command, double measured, double force) = 0;
  /// Coefficients, for the report.
  [[nodiscard]] virtual Eigen::Vector3d coefficients() const { return {1, 0, 0}; }
};

/// How the measured force is corrected.
struct ForceSettings {
  loop::ForceCorrection correction;                             ///< for the machine's own force
  std::optional<controller::TargetForceSettings> target_force;  ///< for the tracking error
  bool knows_offset = false;  ///< else the offset of the load cells is subtracted before
};

/// A way to control the machine: a column of the benchmark.
struct Controller {
  const char* name;
  double feed_forward;  ///< at the valves [-]
  ForceSettings force;
  /// Of one axis: 0 long, 1 lat.
  std::function<std::unique_ptr<Compensator>(std::size_t axis)> compensator;
};

/// No compensation: it measures the raw delay.
[[nodiscard]] Controller bare_controller();
/// The paper's: velocity feed-forward at the valves, and ATS.
[[nodiscard]] Controller paper_controller();
/// Ours: the adaptive inverse, and the force at the target and ahead.
/// @param bearing    as the controller assumes it
/// @param constants  of the blocks observer, target_force and inverse
[[nodiscard]] Controller inverse_controller(const sim::machine::PlatenMachine& nominal,
                                            const sim::Bearing& bearing, const Config& constants);

/// A test of the benchmark.
struct PlatenTest {
  sim::machine::PlatenMachine machine;  ///< with its specimen
  sim::machine::PlatenRun at_rest;      ///< this machine at `kPeriod`; each run begins with a copy
  sim::PlantMatrices plant;
  sim::GroundMotion motion;
  double duration = 40;                  ///< model time [s]
  std::array<bool, 2> axes{true, true};  ///< tested: long, lat
};

/// One sample per controller period (1 ms).
struct AxisHistory {
  std::vector<double> command, measured;  ///< [m]
  std::vector<Eigen::Vector3d> coefficients;
};

struct HybridHistory {
  std::array<AxisHistory, 2> axes;
  std::vector<loop::Command> commands;  ///< for a second run of the same targets
  loop::ResponseHistory response;       ///< of the plant, at the integration step
  bool stable = true;                   ///< false: a stroke was reached
  long limits = 0;                      ///< periods with a limit of the machine reached
};

/// The closed loop in virtual time, as the demo runs it: α-OS with 10 ms and substeps, target 3 ms
/// after the measurement, predictor-corrector at 10 kHz, force observer.
[[nodiscard]] HybridHistory run_hybrid(const PlatenTest& test, const Controller& controller);

/// The same commands sent to the machine again, with another controller and without a plant.
[[nodiscard]] std::array<AxisHistory, 2> replay(const PlatenTest& test, const HybridHistory& from,
                                                const Controller& controller);

/// The loop with an ideal machine: the same integration with the specimen's model.
[[nodiscard]] loop::ResponseHistory numerical_loop(const PlatenTest& test);

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/sim/alpha_os.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/isolated_plant.hpp>
#include <rths/sim/oscillator.hpp>
#include <rths/sim/structure_model.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::sim {

/// A quantity of the bearing during a time step: the parabola through its last three values.
struct BearingPath {
  Eigen::Vector2d now = Eigen::Vector2d::Zero();     ///< at the end of the step
  Eigen::Vector2d last = Eigen::Vector2d::Zero();    ///< at its beginning
  Eigen::Vector2d before = Eigen::Vector2d::Zero();  ///< a step earlier
  void append(const Eigen::Vector2d& value) RTHS_REALTIME;
  /// @param x  part of the step, 0 to 1   @realtime
  [[nodiscard]] Eigen::Vector2d at(double x) const RTHS_REALTIME;
};

/// The degrees of freedom at which a plant meets its bearing: the displacements long and lat, and
/// the compression vert on top of the weight.   @setup
[[nodiscard]] std::vector<InterfaceDof> plant_interface();

/// A plant under a ground motion, integrated one time step at a time.
///
/// With substeps, the plant is integrated in parts of the time step, between the targets. The
/// bearing's force is extrapolated for the target, then interpolated between measured forces.
///
/// Vertically the plant is one mass on bearings, independent of the horizontal motion. A bearing
/// that stands off the centre also carries its part of the overturning moment. The sum is a target
/// for the specimen.
class PlantAnalysis final : public Substructure {
 public:
  /// @param bearing_initial_stiffness  of one bearing [N/m]; unused when the plant has no bearings
  /// @param time_step  between targets [s]
  /// @param substeps   of the integration in a time step
  /// @throws Error as AlphaOs does, and if the bearing is too stiff for substeps   @setup
  // NOLINTNEXTLINE(readability-function-size): the last two have usual values
  PlantAnalysis(PlantMatrices plant, GroundMotion motion, double bearing_initial_stiffness,
                double time_step, double alpha, VerticalFeedback vertical = VerticalFeedback::Model,
                int substeps = 1);

  [[nodiscard]] std::vector<InterfaceDof> interface() const override { return plant_interface(); }
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override;
  void correct(std::span<const double> force) RTHS_REALTIME override;
  [[nodiscard]] double time() const RTHS_REALTIME override { return time_; }
  /// Acceleration of the ground and of each floor.
  [[nodiscard]] std::vector<MonitoredQuantity> monitors() const override;
  void monitor(std::span<double> values) const RTHS_REALTIME override;

  /// Begins a step. @returns the bearing's target displacement at its end: long, lat [m]  @realtime
  Eigen::Vector2d predict() RTHS_REALTIME;
  /// Ends the step.
  /// @param bearing_force  of one bearing at the target [N]
  /// @param vertical_force  measured, on top of the weight, compression [N]; unused with Model
  /// @realtime
  void correct(const Eigen::Vector2d& bearing_force, double vertical_force = 0) RTHS_REALTIME;

  /// Compression added to one bearing by the vertical motion and by overturning, at the end of the
  /// step begun [N]; bounded below by minus the weight (uplift).
  [[nodiscard]] double vertical_force() const { return vertical_force_; }
  [[nodiscard]] Eigen::Vector2d ground_acceleration() const { return ground_; }  ///< [m/s²]
  [[nodiscard]] Eigen::Vector2d predicted_velocity() const;  ///< of the bearing [m/s]
  [[nodiscard]] Eigen::Vector2d base_displacement() const;   ///< corrected [m]
  /// Absolute acceleration of floor `i` of the plant's list [m/s²].
  [[nodiscard]] Eigen::Vector2d floor_acceleration(std::size_t i) const;
  [[nodiscard]] const PlantMatrices& plant() const { return plant_; }

 private:
  void predict_vertical() noexcept;
  [[nodiscard]] double predicted_overturning() const noexcept;
  void extrapolate() noexcept;
  void interpolate() noexcept;
  void load_at(double time) noexcept;

  PlantMatrices plant_;
  GroundMotion motion_;
  double time_step_;
  int substeps_;
  double bearing_stiffness_;  ///< implicit, of all bearings [N/m]
  double time_ = 0;
  std::uint64_t steps_ = 0;
  Eigen::Vector2d ground_ = Eigen::Vector2d::Zero();
  Eigen::MatrixXd inertia_;  ///< −M ι, dof × 2
  Eigen::VectorXd load_, restoring_force_;
  AlphaOs integrator_;
  std::optional<AlphaOs> extrapolation_;  ///< to the next target; with substeps
  BearingPath target_, force_;            ///< of the bearing [m], of all bearings [N]
  /// Compression by overturning per displacement [N/m] and velocity [N·s/m]; empty if there is none
  Eigen::VectorXd overturning_stiffness_, overturning_damping_;
  double overturning_ = 0;  ///< compression at the end of the step begun [N]
  OscillatorStep vertical_step_;
  Oscillator vertical_;
  std::optional<AlphaOs> vertical_integrator_;  ///< of the compression of a bearing; Measured only
  double vertical_stiffness_ = 0, vertical_damping_ = 0;  ///< of one bearing [N/m], [N·s/m]
  double vertical_force_ = 0;                             ///< target [N]
  Eigen::VectorXd vertical_restoring_, vertical_load_;    ///< 1 × 1 [N]
};

}  // namespace rths::sim

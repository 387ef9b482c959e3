// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <rths/plant/basis.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::plant {

struct PlantSettings {
  double time_step = 0.01;        ///< between targets [s]
  double alpha = -0.05;           ///< of α-OS [-], −⅓…0
  double damping_ratio = 0.02;    ///< of the structure alone, proportional to its stiffness,
  double damping_frequency = 10;  ///< at this frequency [Hz]
  /// Damping is also proportional to the bearings' initial stiffness, as in programs that damp all
  /// of K. It is wrong: a bearing that yields keeps the dashpot of its unyielded stiffness.
  bool damps_bearings = false;
  bool counts_energy = false;  ///< see LargePlantAnalysis::energy; a step takes longer
  std::size_t tested_bearing = 0;
  int substeps = 1;  ///< of the integration between targets; energy is counted with 1 alone
  bool monitors_coordinates = false;  ///< of a reduced plant, see Basis::displacement
  /// The vertical force of the tested bearing is that of the specimen, not of a spring.
  bool measures_vertical = false;

  [[nodiscard]] double damping_time() const;  ///< a₁ = 2 ζ/ω [s]
};

/// Energies since the start [J], relative to the ground. Their balance tests the integration: the
/// bearings' work is that of the forces that it used, which are those at the predicted motion.
///
///     kinetic   ½ vᵀM v                   strain   ½ uᵀK u,  of the structure alone
///     damped    ∫ a₁ vᵀK v dt,            and of the bearings' vertical springs
///     absorbed  ∫ fᵀB v dt                by the bearings, the tested one included
///     input     −∫ a_gᵀ(M ι)ᵀ v dt
/// Integrals are by the trapezoidal rule.
struct EnergyBalance {
  double kinetic = 0, strain = 0, damped = 0, absorbed = 0, input = 0;

  /// Of the balance; 0 for an exact integration.
  [[nodiscard]] double error() const { return input - kinetic - strain - damped - absorbed; }
};

class EnergyCount;

/// A large plant on nonlinear bearings, one of them tested: α-OS, one time step at a time.
///
///     ũ = u + Δt v + Δt²(½ − β) a,  ṽ = v + Δt(1 − γ) a              predict: the target is B_e ũ
///     w = (1+α)(ũ + a₁ ṽ) − α(u + a₁ v)
///     M a⁺ + K_I (w + c a⁺) = −M ι((1+α)a_g⁺ − α a_g) − Bᵀ((1+α)d⁺ − α d),
///     c = (1+α)(γ Δt a₁ + β Δt²),   d = f − k_I (u + a₁ v): see BearingField
///
/// Only d of the tested bearing is late. By superposition, its effect on the next target is a fixed
/// 2 × 2 matrix; all else is computed by `work_ahead`, while the machine moves. With a measured
/// vertical force it is a 3 × 3 matrix, and d of the tested bearing includes −F − k u, F: the
/// compression on top of the weight. k a₁ v stays, as the machine is asked for k u alone.
///
/// With substeps, Δt is a part of the time between targets. `work_ahead` integrates from the target
/// that the machine moves to, to the next one, a substep in each call. It extrapolates d of the
/// tested bearing by a straight line. When the force is known, the state moves by the response to
/// the difference: to the parabola through the last three d in the step that ended, and to the new
/// line in the next.
class LargePlantAnalysis : public sim::Substructure {
 public:
  [[nodiscard]] std::vector<sim::InterfaceDof> interface() const override;
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override;
  void work_ahead() RTHS_REALTIME override;
  void correct(std::span<const double> force) RTHS_REALTIME override;
  [[nodiscard]] double time() const RTHS_REALTIME override {
    return static_cast<double>(steps_) * settings_.time_step;
  }
  /// Acceleration of the ground and of each floor: long, lat, vert; loads of the bearings; energies
  /// and coordinates if the settings ask for them.
  [[nodiscard]] std::vector<sim::MonitoredQuantity> monitors() const override;
  void monitor(std::span<double> values) const RTHS_REALTIME override;

  [[nodiscard]] const BearingField& bearings() const { return bearings_; }
  /// 0 unless the settings ask for it.
  [[nodiscard]] EnergyBalance energy() const RTHS_REALTIME;
  ~LargePlantAnalysis() override;

 protected:
  /// Of the tested bearing: long, lat, and vertical if that is measured.
  using TestedForce = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kDirections, 1>;

  LargePlantAnalysis(const BearingSet& bearings, const VectorXd& weights, sim::GroundMotion motion,
                     const std::vector<Floor>& floors, const PlantSettings& settings);

  /// State of the integration: displacement, velocity and acceleration, and their predictions.
  struct State {
    VectorXd u, v, a, predicted_u, predicted_v, w;
  };
  /// Motion of the tested bearing in a state: displacement and velocity, 3 × 2.
  [[nodiscard]] virtual Eigen::Matrix<double, 3, 2> tested_motion(
      const VectorXd& u, const VectorXd& v) const RTHS_REALTIME = 0;
  /// Motion of all bearings in the predicted state, 3 × bearings rows, 2 columns.
  void bearing_motion(MatrixXd& motion) const RTHS_REALTIME {
    motion_at_bearings(state_.predicted_u, state_.predicted_v, motion);
  }
  /// The same of any displacement and velocity.
  virtual void motion_at_bearings(const VectorXd& u, const VectorXd& v,
                                  MatrixXd& motion) const RTHS_REALTIME = 0;
  /// Solves for the acceleration without the tested bearing's d.
  /// @param ground      (1+α)a_g⁺ − α a_g
  /// @param correction  (1+α)d⁺ − α d of all bearings
  virtual void solve(const Eigen::Vector3d& ground, const VectorXd& correction) RTHS_REALTIME = 0;
  /// Adds the effect of (1+α)d⁺ of the tested bearing to the acceleration.
  virtual void add_tested(const TestedForce& correction) RTHS_REALTIME = 0;
  /// Relative acceleration of the floors, 3 × floors.
  virtual void floor_motion(VectorXd& acceleration) const RTHS_REALTIME = 0;
  /// M x, K_I x and M ι a_g, for the energy.
  virtual void multiply_mass(const VectorXd& x, VectorXd& result) const RTHS_REALTIME = 0;
  virtual void multiply_stiffness(const VectorXd& x, VectorXd& result) const RTHS_REALTIME = 0;
  virtual void multiply_inertia(const Eigen::Vector3d& ground,
                                VectorXd& result) const RTHS_REALTIME = 0;

  [[nodiscard]] const PlantSettings& settings() const { return settings_; }
  [[nodiscard]] double damping_time() const { return damping_time_; }      ///< a₁ [s]
  [[nodiscard]] double implicit_share() const { return implicit_share_; }  ///< c [s²]
  /// Ends the construction. @param size  coordinates
  void begin_at_rest(Index size);
  /// After `predict`: displacement whose part at the tested bearing is the target.
  [[nodiscard]] const VectorXd& target_displacement() const RTHS_REALTIME {
    return settings_.substeps == 1 ? state_.predicted_u : state_.u;
  }
  State state_;

 private:
  /// Responses to a change of d of the tested bearing by 1 N, in each of its directions.
  struct Responses {
    MatrixXd u, v, a;  ///< of the state at the next target
    MatrixXd floors;   ///< of their acceleration at the target before it
  };
  void find_responses();
  void require_slow_bearing() const;
  [[nodiscard]] Eigen::Vector2d spring_force(const Eigen::Vector2d& displacement) const;
  void predict_state() RTHS_REALTIME;
  void correct_state() RTHS_REALTIME;
  void solve_step(double time, const TestedForce& tested) RTHS_REALTIME;
  void integrate_substep() RTHS_REALTIME;
  [[nodiscard]] bool is_ahead() const RTHS_REALTIME {
    return substeps_ahead_ == settings_.substeps;
  }
  void correct_with_substeps(const TestedForce& correction) RTHS_REALTIME;

  PlantSettings settings_;
  double step_;  // of the integration [s]
  double beta_, gamma_, damping_time_, implicit_share_;
  sim::GroundMotion motion_;
  BearingField bearings_;
  std::size_t floors_;
  MatrixXd bearing_motion_;
  VectorXd correction_, last_correction_, mixed_correction_;
  mutable VectorXd floor_acceleration_;
  Eigen::Vector3d ground_ = Eigen::Vector3d::Zero(), monitored_ground_ = ground_;
  Eigen::Matrix<double, 3, 2> target_motion_;  // of the tested bearing
  Responses responses_;                        // with substeps
  TestedForce tested_, next_tested_;           // d at targets [N]
  std::unique_ptr<EnergyCount> energy_;        // none: not counted
  std::size_t steps_ = 0;
  friend class EnergyCount;
  int substeps_ahead_;  // since the last target
};

/// In the coordinates of a reduced basis: a step takes the same time for any number of degrees of
/// freedom.
/// @throws Error if the basis has other bearings or floors, a setting is out of range, or substeps
///         are too long for the tested bearing   @setup
[[nodiscard]] std::unique_ptr<LargePlantAnalysis> make_reduced(const Basis& basis,
                                                               const BearingSet& bearings,
                                                               const sim::GroundMotion& motion,
                                                               const std::vector<Floor>& floors,
                                                               const PlantSettings& settings);
/// With all degrees of freedom, for reference: a sparse solution in each step.
/// @throws Error as Factor, and for settings as make_reduced   @setup
[[nodiscard]] std::unique_ptr<LargePlantAnalysis> make_full(const Structure& structure,
                                                            const BearingSet& bearings,
                                                            const sim::GroundMotion& motion,
                                                            const PlantSettings& settings);

}  // namespace rths::plant

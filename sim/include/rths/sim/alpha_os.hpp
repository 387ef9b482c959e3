// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <rths/core/realtime.hpp>

namespace rths::sim {

/// The operator-splitting integrator α-OS: explicit for the specimen, implicit for the rest.
///
///     ũ = u + Δt v + Δt²(½ − β) a,   ṽ = v + Δt(1 − γ) a                      predict
///     r = r̃(ũ) + K_I (u − ũ)                                    splitting of the restoring force
///     M a⁺ + (1+α)(C v⁺ + r⁺) − α(C v + r) = (1+α) f⁺ − α f,
///     u⁺ = ũ + β Δt² a⁺,  v⁺ = ṽ + γ Δt a⁺                                    correct
///     β = (1 − α)²/4,  γ = (1 − 2α)/2,  −⅓ ≤ α ≤ 0
///
/// One constant factorisation, one solve per step. Unconditionally stable while the tangent
/// stiffness does not exceed K_I. Source: Combescure & Pegon (1997).
class AlphaOs {
 public:
  /// @param K_I  implicit stiffness: the structure's plus the specimen's initial one [N/m]
  /// @param dt   time step [s], > 0
  /// @param alpha  dissipation [-], −⅓…0
  /// @throws Error if the sizes differ, dt or alpha is out of range, or M̂ is not positive definite
  /// @setup
  AlphaOs(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C, const Eigen::MatrixXd& K_I, double dt,
          double alpha);

  /// Sets displacement, velocity, acceleration and forces to zero.
  void reset();
  /// Takes over displacement, velocity, acceleration and forces of an integrator of the same
  /// size.   @realtime
  void continue_from(const AlphaOs& other) RTHS_REALTIME;
  /// First half of a step. @returns ũ, dof × 1 [m], the specimen's target displacement  @realtime
  const Eigen::VectorXd& predict() RTHS_REALTIME;
  /// Second half of a step.
  /// @param restoring_force  r̃(ũ) of structure and specimen, dof × 1 [N]
  /// @param load             f at the end of the step, dof × 1 [N]   @realtime
  void correct(const Eigen::VectorXd& restoring_force, const Eigen::VectorXd& load) RTHS_REALTIME;

  [[nodiscard]] const Eigen::VectorXd& displacement() const { return u_; }  ///< [m]
  [[nodiscard]] const Eigen::VectorXd& velocity() const { return v_; }      ///< [m/s]
  [[nodiscard]] const Eigen::VectorXd& acceleration() const { return a_; }  ///< [m/s²]
  /// ũ of the last `predict` [m].
  [[nodiscard]] const Eigen::VectorXd& predicted_displacement() const { return u_predicted_; }
  /// Rate of ũ, for targets that carry a velocity [m/s].
  [[nodiscard]] const Eigen::VectorXd& predicted_velocity() const { return v_predicted_; }

 private:
  double dt_, alpha_, beta_, gamma_;
  Eigen::MatrixXd C_, K_I_;
  Eigen::LLT<Eigen::MatrixXd> effective_mass_;  ///< M + (1+α)(γΔt C + βΔt² K_I)
  Eigen::VectorXd u_, v_, a_;
  Eigen::VectorXd u_predicted_, v_predicted_;
  Eigen::VectorXd restoring_force_, load_;  ///< r and f at the beginning of the step
  Eigen::VectorXd rhs_, scratch_;
};

}  // namespace rths::sim

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <vector>

#include <Eigen/Core>

namespace rths::adapters {

/// Identifies initial stiffness, damping and mass of a specimen by small motions before the test.
///
/// Moves one component after another at two frequencies at once, with a smooth start and end. The
/// amplitudes of displacement D and force F at each frequency give the dynamic stiffness
///
///     Z(ω) = F·D⁻¹ = K − ω²·M + iω·C
///
/// at both frequencies, and these give K, M and C. Sensor noise averages out. Delays of the machine
/// have no effect, because displacement and force are both measured.
class SpecimenIdentification {
 public:
  /// @param components  number of moved components, n
  /// @param amplitude   of each [m, rad], > 0
  /// @param step        time between targets [s]
  SpecimenIdentification(Eigen::Index components, const Eigen::VectorXd& amplitude, double step);

  [[nodiscard]] bool is_done() const;
  /// The next target, n.   @pre !is_done()
  [[nodiscard]] Eigen::VectorXd target() const;
  /// Takes the measurement at the last target: n displacements and n restoring forces.
  void measure(const Eigen::VectorXd& displacement, const Eigen::VectorXd& force);

  struct Properties {
    Eigen::MatrixXd stiffness, damping, mass;  ///< n × n
  };
  /// @throws Error if a component did not move, or a stiffness is not positive   @pre is_done()
  [[nodiscard]] Properties properties() const;

 private:
  static constexpr std::size_t kFrequencies = 2;
  [[nodiscard]] double time() const;
  void start_component();
  void finish_component();
  [[nodiscard]] std::array<Eigen::MatrixXcd, kFrequencies> dynamic_stiffness() const;

  Eigen::Index components_;
  Eigen::VectorXd amplitude_;
  double step_;
  int steps_;                          ///< per component
  Eigen::Index at_ = 0;                ///< current component
  int taken_ = 0;                      ///< its completed steps
  Eigen::MatrixXd normal_, observed_;  ///< of the current fit
  /// Complex amplitudes at both frequencies, a column per moved component.
  std::array<Eigen::MatrixXcd, kFrequencies> displacement_, force_;
};

}  // namespace rths::adapters

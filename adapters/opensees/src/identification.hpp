// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <vector>

#include <Eigen/Core>

namespace rths::adapters {

/// Initial stiffness, damping and mass of a specimen, found by shaking it a little before the test:
/// one component after the other at two frequencies at once, with a gentle beginning and end. What
/// displacement and force have of each frequency gives the dynamic stiffness
///
///     Z(ω) = F·D⁻¹ = K − ω²·M + iω·C
///
/// of both frequencies, and these the three. Sensor noise averages out; delays of the machine do
/// not matter, since both are measured.
class Identification {
 public:
  /// @param components  to be moved, n
  /// @param amplitude   of each [m, rad], > 0
  /// @param step        from target to target [s]
  Identification(Eigen::Index components, const Eigen::VectorXd& amplitude, double step);

  /// The next target, n, or nothing: it is done.
  [[nodiscard]] bool is_done() const;
  [[nodiscard]] Eigen::VectorXd target() const;
  /// What was measured there: n displacements and n restoring forces.
  void measure(const Eigen::VectorXd& displacement, const Eigen::VectorXd& force);

  struct Found {
    Eigen::MatrixXd stiffness, damping, mass;  ///< n × n
  };
  /// @throws Error if a component did not move when it was told to, or what was found is no
  ///         stiffness   @pre is_done()
  [[nodiscard]] Found found() const;

 private:
  static constexpr std::size_t kFrequencies = 2;
  [[nodiscard]] double time() const;
  void start_component();
  void finish_component();
  [[nodiscard]] std::array<Eigen::MatrixXcd, kFrequencies> dynamic_stiffness() const;

  Eigen::Index components_;
  Eigen::VectorXd amplitude_;
  double step_;
  int steps_;                          ///< of one component
  Eigen::Index at_ = 0;                ///< component in hand
  int taken_ = 0;                      ///< steps of it
  Eigen::MatrixXd normal_, observed_;  ///< of the fit in hand
  /// Complex amplitudes of both frequencies, a column for each component that was moved.
  std::array<Eigen::MatrixXcd, kFrequencies> displacement_, force_;
};

}  // namespace rths::adapters

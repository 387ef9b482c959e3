// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <rths/plant/structure.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::plant {

/// The bearings of a plant: kinds, and the kind at each place.
struct BearingSet {
  std::vector<sim::Bearing> kinds;
  std::vector<std::size_t> kind_of;  ///< of each bearing of the structure
  double vertical_stiffness = 8e9;   ///< of one bearing in compression [N/m]
  double tension_share = 0.01;       ///< of it, once the bearing lifts off [-]
  /// Real bearings that each stands for: force, stiffness and weight of one, times this, act on the
  /// structure [-].
  double stands_for = 1;

  /// The same bearing everywhere.
  [[nodiscard]] static BearingSet all_of(const sim::Bearing& bearing, std::size_t count);
};

/// Linear springs of one bearing, for a basis: long, lat and vertical [N/m].
struct BearingStiffness {
  std::array<double, kDirections> initial{};     ///< largest, implicit in the integration
  std::array<double, kDirections> post_yield{};  ///< tangent at a large displacement
};
/// @throws Error if a bearing has no stiffness or no kind   @setup
[[nodiscard]] std::vector<BearingStiffness> stiffness_of(const BearingSet& bearings);
/// K on the springs of all bearings, for instance on `&BearingStiffness::initial`.
/// @throws Error as stiffness_of and Structure::on_springs   @setup
[[nodiscard]] SparseMatrix on_springs(const Structure& structure, const BearingSet& bearings,
                                      std::array<double, kDirections> BearingStiffness::*springs);

/// What each bearing adds to its initial stiffness and to its damping a₁ k, in every time step:
///     d = f(u, v) − k (u + a₁ v)                      horizontally
///     d = (1 − tension share) min(weight − k (u + a₁ v), 0)   vertically: lift-off alone
class BearingField {
 public:
  /// @param weights  static compression of each bearing [N]
  /// @throws Error as sim::Composition does   @setup
  BearingField(const BearingSet& bearings, const VectorXd& weights, double time_step,
               double damping_time);

  /// @param motion  displacement and velocity from equilibrium, 3 × bearings rows, 2 columns
  /// @param tested  bearing whose horizontal force comes from elsewhere
  /// @param correction  overwritten: d, 3 × bearings; 0 for the horizontal ones of `tested`
  /// @realtime
  void advance(const MatrixXd& motion, std::size_t tested, VectorXd& correction) RTHS_REALTIME;

  /// Compression of a bearing [N] for an upward displacement [m].
  [[nodiscard]] double compression(std::size_t bearing, double up) const RTHS_REALTIME {
    return weights_[static_cast<Index>(bearing)] - vertical_stiffness_ * up;
  }
  /// d of one bearing for its horizontal force: long, lat [N].
  [[nodiscard]] Eigen::Vector2d correction_for(
      std::size_t bearing, const Eigen::Vector2d& force, const Eigen::Vector2d& displacement,
      const Eigen::Vector2d& velocity) const RTHS_REALTIME {
    return force - stiffness_[bearing] * (displacement + damping_time_ * velocity);
  }
  /// d of one bearing for its vertical force: −F − k u.
  /// @param compression  F, on top of the weight [N]   @param up  u [m]
  [[nodiscard]] double vertical_correction_for(double compression, double up) const RTHS_REALTIME {
    return -compression - vertical_stiffness_ * up;
  }
  /// Restoring forces f of the bearings, from a motion and its d [N].
  void forces(const MatrixXd& motion, const VectorXd& correction,
              VectorXd& forces) const RTHS_REALTIME;
  /// The damping a₁ k v of initial springs that d takes away [N].
  void damping(const MatrixXd& motion, VectorXd& forces) const RTHS_REALTIME;
  /// Strain energy of the initial springs at a displacement [J].
  [[nodiscard]] double strain(const MatrixXd& motion) const RTHS_REALTIME;
  /// Real bearings that each stands for [-].
  [[nodiscard]] double stands_for() const RTHS_REALTIME { return stands_for_; }
  /// Of the last motion.
  struct Loads {
    double least = 0, largest = 0;  ///< compression of a bearing [N]
    double lifted = 0;              ///< bearings that pull [-]
  };
  [[nodiscard]] const Loads& loads() const RTHS_REALTIME { return loads_; }
  /// Bearings that have lifted off in any step so far.
  [[nodiscard]] std::size_t lifted() const;
  /// Smallest and largest compression so far [N].
  [[nodiscard]] double least_load() const { return least_; }
  [[nodiscard]] double largest_load() const { return largest_; }

 private:
  std::vector<sim::Composition> kinds_;
  std::vector<double> temperatures_;  ///< of the kinds [°C]
  std::vector<std::size_t> kind_of_, first_state_;
  std::vector<double> states_;     ///< of all bearings
  std::vector<double> stiffness_;  ///< horizontal, initial, of each [N/m]
  std::vector<char> has_lifted_;
  Loads loads_;
  VectorXd weights_;
  double vertical_stiffness_, tension_share_, stands_for_, damping_time_, time_step_;
  double time_ = 0, least_, largest_;
};

}  // namespace rths::plant

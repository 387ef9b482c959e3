// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/large_plant_analysis.hpp>

namespace rths::plant {
namespace {

SparseMatrix on_initial_springs(const Structure& structure, const BearingSet& bearings) {
  return on_springs(structure, bearings, &BearingStiffness::initial);
}

VectorXd weights_of(const Structure& structure, const BearingSet& bearings) {
  Factor factor{on_initial_springs(structure, bearings)};
  return static_weights(structure, bearings, factor);
}

// M + c K_I.
SparseMatrix effective_mass(const Structure& structure, const BearingSet& bearings, double share) {
  SparseMatrix sum = share * on_initial_springs(structure, bearings);
  sum.diagonal() += structure.mass;
  return sum;
}

/// Because the damping of the bearings' springs is in d, no product with K is needed:
///     (M + c K_I)(a⁺ + w/c) = −M ι a_g − Bᵀ d + M w/c
class FullPlant final : public LargePlantAnalysis {
 public:
  FullPlant(const Structure& structure, const BearingSet& bearings, const sim::GroundMotion& motion,
            const PlantSettings& settings)
      : LargePlantAnalysis{bearings, weights_of(structure, bearings), motion, structure.floors,
                           settings},
        mass_{structure.mass},
        inertia_{structure.inertia()},
        factor_{effective_mass(structure, bearings, implicit_share())},
        load_{VectorXd::Zero(structure.dofs())},
        bearings_{structure.bearing_motion()},
        tested_{bearings_.middleRows(static_cast<Index>(kDirections * settings.tested_bearing),
                                     static_cast<Index>(kDirections))} {
    for (const auto& floor : structure.floors)
      for (const Index dof : structure.nodes[floor.node].dofs) floor_dofs_.push_back(dof);
    if (settings.counts_energy) stiffness_ = on_initial_springs(structure, bearings);
    tested_responses_.resize(structure.dofs(), settings.measures_vertical ? 3 : 2);
    for (Index k = 0; k < tested_responses_.cols(); ++k) {
      load_ = tested_.transpose() * Eigen::Vector3d::Unit(k);
      factor_.solve(load_, solution_);
      tested_responses_.col(k) = solution_;
    }
    begin_at_rest(structure.dofs());
  }

 protected:
  [[nodiscard]] Eigen::Matrix<double, 3, 2> tested_motion(
      const VectorXd& u, const VectorXd& v) const RTHS_REALTIME override {
    Eigen::Matrix<double, 3, 2> motion;
    motion.col(0).noalias() = tested_ * u;
    motion.col(1).noalias() = tested_ * v;
    return motion;
  }
  void motion_at_bearings(const VectorXd& u, const VectorXd& v,
                          MatrixXd& motion) const RTHS_REALTIME override {
    motion.col(0).noalias() = bearings_ * u;
    motion.col(1).noalias() = bearings_ * v;
  }
  void solve(const Eigen::Vector3d& ground, const VectorXd& correction) RTHS_REALTIME override {
    const double share = implicit_share();
    load_ = mass_.cwiseProduct(state_.w) / share;
    load_.noalias() -= inertia_ * ground;
    load_.noalias() -= bearings_.transpose() * correction.head(bearings_.rows());
    factor_.solve(load_, solution_);
    state_.a = solution_ - state_.w / share;
  }
  void add_tested(const TestedForce& correction) RTHS_REALTIME override {
    state_.a.noalias() -= tested_responses_ * correction;
  }
  void floor_motion(VectorXd& acceleration) const RTHS_REALTIME override {
    for (std::size_t i = 0; i < floor_dofs_.size(); ++i)
      acceleration[static_cast<Index>(i)] = state_.a[floor_dofs_[i]];
  }
  void multiply_mass(const VectorXd& x, VectorXd& result) const RTHS_REALTIME override {
    result = mass_.cwiseProduct(x);
  }
  void multiply_stiffness(const VectorXd& x, VectorXd& result) const RTHS_REALTIME override {
    result.noalias() = stiffness_ * x;
  }
  void multiply_inertia(const Eigen::Vector3d& ground,
                        VectorXd& result) const RTHS_REALTIME override {
    result.noalias() = inertia_ * ground;
  }

 private:
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  VectorXd mass_;
  MatrixXd inertia_;
  Factor factor_;
  VectorXd load_, solution_;
  Rows bearings_, tested_;  // B, and its rows of the tested bearing
  std::vector<Index> floor_dofs_;
  MatrixXd tested_responses_;  // to unit forces of the tested bearing
  SparseMatrix stiffness_;     // on initial springs; for the energy alone
};

}  // namespace

std::unique_ptr<LargePlantAnalysis> make_full(const Structure& structure,
                                              const BearingSet& bearings,
                                              const sim::GroundMotion& motion,
                                              const PlantSettings& settings) {
  return std::make_unique<FullPlant>(structure, bearings, motion, settings);
}

}  // namespace rths::plant

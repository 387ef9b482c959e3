// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/large_plant_analysis.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "shapes.hpp"

namespace rths::plant {
namespace {

class ReducedPlant final : public LargePlantAnalysis {
 public:
  ReducedPlant(const Basis& basis, const BearingSet& bearings, const sim::GroundMotion& motion,
               const std::vector<Floor>& floors, const PlantSettings& settings)
      : LargePlantAnalysis{bearings, basis.weights, motion, floors, settings},
        stiffness_{basis.stiffness},
        compliance_{(1 + implicit_share() * basis.stiffness.array()).inverse()},
        shapes_{basis.bearings},
        tested_{basis.bearings.middleRows<3>(
            static_cast<Index>(kDirections * settings.tested_bearing))},
        floors_{basis.floors},
        participation_{basis.participation},
        load_{VectorXd::Zero(basis.coordinates())} {
    if (settings.monitors_coordinates) {
      at_target_.setZero(basis.coordinates());
      to_metres_ = basis.to_metres();
    }
    begin_at_rest(basis.coordinates());
  }

  // The motion that the machine is asked to follow: with substeps, the state runs ahead of it.
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override {
    LargePlantAnalysis::predict(target, rate);
    if (at_target_.size() > 0) at_target_ = target_displacement();
  }
  [[nodiscard]] std::vector<sim::MonitoredQuantity> monitors() const override {
    auto monitors = LargePlantAnalysis::monitors();
    for (Index i = 1; i <= at_target_.size(); ++i) monitors.push_back({coordinate_name(i), "m"});
    return monitors;
  }
  void monitor(std::span<double> values) const RTHS_REALTIME override {
    const auto count = static_cast<std::size_t>(at_target_.size());
    const auto others = values.size() - count;
    LargePlantAnalysis::monitor(values.first(others));
    VectorXd::Map(values.data() + others, at_target_.size()) = to_metres_ * at_target_;
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
    shapes_.multiply(u, v, motion);
  }
  void solve(const Eigen::Vector3d& ground, const VectorXd& correction) RTHS_REALTIME override {
    shapes_.multiply_transposed(correction, load_);
    load_.noalias() += participation_ * ground;
    state_.a = -compliance_.array() * (load_.array() + stiffness_.array() * state_.w.array());
  }
  void add_tested(const TestedForce& correction) RTHS_REALTIME override {
    state_.a.array() -= compliance_.array() * (tested_.row(0).transpose().array() * correction[0] +
                                               tested_.row(1).transpose().array() * correction[1]);
    if (correction.size() > 2)
      state_.a.array() -= compliance_.array() * tested_.row(2).transpose().array() * correction[2];
  }
  void floor_motion(VectorXd& acceleration) const RTHS_REALTIME override {
    acceleration.noalias() = floors_ * state_.a;
  }
  void multiply_mass(const VectorXd& x, VectorXd& result) const RTHS_REALTIME override {
    result = x;
  }
  void multiply_stiffness(const VectorXd& x, VectorXd& result) const RTHS_REALTIME override {
    result = stiffness_.cwiseProduct(x);
  }
  void multiply_inertia(const Eigen::Vector3d& ground,
                        VectorXd& result) const RTHS_REALTIME override {
    result.noalias() = participation_ * ground;
  }

 private:
  VectorXd stiffness_, compliance_;
  Shapes shapes_;  // at all bearings
  Eigen::Matrix<double, 3, Eigen::Dynamic> tested_;
  MatrixXd floors_, participation_;
  VectorXd load_;
  VectorXd at_target_;  // coordinates at the last target, if they are monitored
  double to_metres_ = 0;
};

}  // namespace

std::unique_ptr<LargePlantAnalysis> make_reduced(const Basis& basis, const BearingSet& bearings,
                                                 const sim::GroundMotion& motion,
                                                 const std::vector<Floor>& floors,
                                                 const PlantSettings& settings) {
  const auto require = [](Index found, std::size_t expected, const char* what) {
    if (found != static_cast<Index>(kDirections * expected))
      throw Error{fmt::format("plant: the basis has {} {}, expected {}",
                              found / static_cast<Index>(kDirections), what, expected)};
  };
  require(basis.bearings.rows(), bearings.kind_of.size(), "bearings");
  require(basis.floors.rows(), floors.size(), "floors");
  return std::make_unique<ReducedPlant>(basis, bearings, motion, floors, settings);
}

}  // namespace rths::plant

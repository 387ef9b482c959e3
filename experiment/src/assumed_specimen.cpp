// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/block_settings.hpp>

#include <cmath>
#include <utility>

#include <rths/core/axis.hpp>

namespace rths::experiment {
namespace {

/// A bearing along some of its axes.
class AssumedSpecimen final : public controller::SpecimenModel {
 public:
  /// @param directions  of the axes: 0 long, 1 lat
  AssumedSpecimen(const sim::Bearing& bearing, std::vector<Eigen::Index> directions, double period)
      : run_{bearing, period},
        load_at_rest_{bearing.axial_load},
        directions_{std::move(directions)},
        force_{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(directions_.size()))} {}

  [[nodiscard]] const Eigen::VectorXd& move(const Eigen::VectorXd& displacement,
                                            const Eigen::VectorXd& velocity,
                                            double axial_load) noexcept override {
    Eigen::Vector2d u = Eigen::Vector2d::Zero(), v = u;
    for (Eigen::Index i = 0; i < force_.size(); ++i) {
      u[direction(i)] = displacement[i];
      v[direction(i)] = velocity[i];
    }
    const Eigen::Vector2d force =
        run_.advance(u, v, std::isfinite(axial_load) ? axial_load : load_at_rest_);
    for (Eigen::Index i = 0; i < force_.size(); ++i) force_[i] = force[direction(i)];
    return force_;
  }

 private:
  [[nodiscard]] Eigen::Index direction(Eigen::Index axis) const {
    return directions_[static_cast<std::size_t>(axis)];
  }

  sim::BearingRun run_;
  double load_at_rest_;
  std::vector<Eigen::Index> directions_;
  Eigen::VectorXd force_;
};

}  // namespace

controller::MakeSpecimen assumed_specimen(const sim::Bearing& bearing,
                                          const std::vector<std::string>& axes, double period) {
  std::vector<Eigen::Index> directions;
  for (const auto& axis : axes) directions.push_back(axis == name_of(Axis::Lat) ? 1 : 0);
  return [bearing, directions, period] {
    return std::make_unique<AssumedSpecimen>(bearing, directions, period);
  };
}

}  // namespace rths::experiment

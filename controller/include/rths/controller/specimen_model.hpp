// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// The specimen in motion, as a test assumes it.
class SpecimenModel {
 public:
  virtual ~SpecimenModel() = default;
  /// Moves it for one period.
  /// @param displacement,velocity  at the end of the period, axes × 1 [m], [m/s]
  /// @param axial_load  compression [N]; not a number: that at rest
  /// @returns the restoring force, axes × 1 [N]; valid until the next call   @realtime
  [[nodiscard]] virtual const Eigen::VectorXd& move(const Eigen::VectorXd& displacement,
                                                    const Eigen::VectorXd& velocity,
                                                    double axial_load) RTHS_REALTIME = 0;
};

/// Makes a specimen at rest.
using MakeSpecimen = std::function<std::unique_ptr<SpecimenModel>()>;

}  // namespace rths::controller

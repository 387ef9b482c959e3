// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include <rths/sim/term.hpp>

#include "relation.hpp"

namespace rths::diagnosis {

using Axes = std::array<Eigen::VectorXd, sim::kHorizontalAxes>;  ///< long, lat

/// How fast a composition is run and compared.
struct Pace {
  double model_rate;    ///< at most [Hz]
  double cutoff;        ///< of the filter that prediction and measurement take [Hz]
  double compare_rate;  ///< at most [Hz]
};

/// What moves a composition, at its own rate: one number per step, empty where not recorded.
class MotionDrive final : public Drive {
 public:
  double model_step = 0;           ///< [s]
  int thinning = 1;                ///< steps per row
  double cutoff = 0;               ///< [Hz]; 0: not filtered
  Eigen::Index all_rows = 0;       ///< before the last ones are dropped, which the filters spoil
  Axes motion, rate, second_rate;  ///< [m], [m/s], [m/s²]
  Axes specimen_force;             ///< known beforehand, of actuators that yield under it [N]
  Eigen::VectorXd axial_load, temperature;  ///< [N], [K]
  Eigen::VectorXd auxiliary;                ///< first of what controls a device [its unit]

  /// What a specimen made of this motion the last time: most suppositions leave it as it is.
  struct Known {
    std::string signature;
    std::vector<double> parameters;
    Axes output;
  };
  mutable std::optional<Known> known;

  /// Takes one signal of the model's rate to the rows that are compared.
  [[nodiscard]] Eigen::VectorXd compared(const Eigen::VectorXd& signal) const;
};

/// What is read from a record, and what is predicted of it.
struct MotionChannels {
  std::string motion;     ///< family that moves the composition: "displacement", "command"
  std::string predicted;  ///< family that it predicts: "force", "displacement", "acceleration"
  bool fuses_acceleration = false;  ///< into the motion, where it was measured
  bool fuses_prediction = false;    ///< into the displacement that is predicted
};

/// Mean over the quiet stretch is taken out of motions; without one, nothing is.
/// @param axes  those that both motion and prediction were recorded of
/// @throws Error if the record lacks the motion
[[nodiscard]] std::unique_ptr<MotionDrive> motion_drive(const Record& record,
                                                        const MotionChannels& channels,
                                                        const std::vector<std::size_t>& axes,
                                                        const Pace& pace);

[[nodiscard]] const std::string& axis_name(std::size_t axis);

}  // namespace rths::diagnosis

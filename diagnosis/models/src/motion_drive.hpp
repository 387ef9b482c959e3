// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <rths/identification/relation.hpp>
#include <rths/sim/term.hpp>

namespace rths::diagnosis {

using Axes = std::array<VectorXd, sim::kHorizontalAxes>;  ///< long, lat

/// Rates at which a composition runs and is compared.
struct SampleRates {
  double model_rate;    ///< at most [Hz]
  double cutoff;        ///< of the filter of prediction and measurement [Hz]
  double compare_rate;  ///< at most [Hz]
  /// Of a filter of motions into which no acceleration is fused [Hz]; 0: none.
  double motion_cutoff = 0;
  /// Of the filter of all signals that drive the composition, at most [Hz]; 0: by the model's rate.
  double drive_cutoff = 0;
};

/// Signals that drive a composition, at its rate: one number per step, empty if not recorded.
class MotionDrive final : public Drive {
 public:
  double model_step = 0;             ///< [s]
  int thinning = 1;                  ///< steps per row
  Index all_rows = 0;                ///< rows not spoilt by the ends of the filters
  Axes motion, rate, second_rate;    ///< [m], [m/s], [m/s²]
  Axes specimen_force;               ///< recorded; actuators may yield under it [N]
  VectorXd axial_load, temperature;  ///< [N], [K]
  VectorXd auxiliary;                ///< first channel that controls a device [its unit]

  /// Filters and thins a signal at the model's rate to the compared rows.
  [[nodiscard]] VectorXd compared(const VectorXd& signal) const;
  [[nodiscard]] MatrixXd compared_columns(const MatrixXd& signals) const;
};

/// Channels of a record that drive a composition, and channels that it predicts.
struct MotionChannels {
  std::string motion;     ///< family that drives the composition: "displacement", "command"
  std::string predicted;  ///< predicted family: "force", "displacement", "acceleration"
  bool fuses_acceleration = false;  ///< into the motion, where it was measured
  bool fuses_prediction = false;    ///< into the predicted displacement
};

/// Prepares a record. Motions have their mean over the quiet interval removed, if there is one.
/// @param axes  axes of which both motion and prediction were recorded
/// @throws Error if the record lacks the motion
[[nodiscard]] std::unique_ptr<MotionDrive> motion_drive(const Record& record,
                                                        const MotionChannels& channels,
                                                        const std::vector<std::size_t>& axes,
                                                        const SampleRates& pace);

/// Cutoff of a filter that removes from motions only what is noise, as intervals at rest show [Hz].
/// 0: they do not show it, or the filter would remove nothing.
[[nodiscard]] double motion_cutoff(const std::vector<const Record*>& records,
                                   const MotionChannels& channels,
                                   const std::vector<std::size_t>& axes);

[[nodiscard]] const std::string& axis_name(std::size_t axis);

}  // namespace rths::diagnosis

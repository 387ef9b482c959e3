// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Progress of a signal along its path in one tick. A predictor-corrector whose target is late
/// passes less than a period of its command's path.
struct Pace {
  double share = 1;        ///< of a period, 0…1
  double curvature = 1;    ///< share of the second and higher derivatives in a lead, 0…1
  double force_share = 1;  ///< of the force beside it; 1 if that is measured
  double in_clock = 0;     ///< part of the signal that follows the clock, not the path
  double lead = 1;         ///< share of the lead of the part along the path, 0…1
};

/// Pace of a command from its lost time. The targets after a late one are rougher: its lead leaves
/// out most of their high derivatives for a while.
class PaceMeter {
 public:
  /// @param lost_time  of the predictor-corrector [s]   @param period  of the ticks [s]
  /// @param is_force_ahead  the force beside it is that of the last tick's command, not measured
  /// @realtime
  Pace operator()(double lost_time, double period, bool is_force_ahead = false) RTHS_REALTIME {
    const double force_share = is_force_ahead ? share_ : 1;
    share_ = std::clamp(1 - (lost_time - last_) / period, 0.0, 1.0);
    last_ = lost_time;
    left_out_ += (1 - share_) * period / kFall * (kMostLeftOut - left_out_);
    left_out_ -= share_ * period / kRise * left_out_;
    if (left_out_ < kNegligible) left_out_ = 0;
    return {share_, 1 - left_out_, force_share};
  }

 private:
  static constexpr double kFall = 0.005, kRise = 0.2;  // time constants [s]
  static constexpr double kMostLeftOut = 0.7, kNegligible = 1e-3;
  double last_ = 0;      // lost time [s]
  double share_ = 1;     // of the last tick
  double left_out_ = 0;  // of the curvature
};

/// Samples a signal at equal intervals of its path. At full pace these are the values of the ticks.
class PathSampler {
 public:
  /// One tick.
  /// @param share  of a period along the path since the last tick, 0…1
  /// @returns the value at a sample that was passed, between those of both ticks   @realtime
  std::optional<double> operator()(double value, double share) RTHS_REALTIME {
    const double before = std::exchange(value_, value);
    if (!std::exchange(has_begun_, true)) return value;
    since_ += share;
    if (since_ < 1) return std::nullopt;
    since_ -= 1;
    return value - since_ / share * (value - before);
  }
  /// Share of a period along the path since the last sample, below 1.
  [[nodiscard]] double since() const { return since_; }

 private:
  bool has_begun_ = false;
  double value_ = 0, since_ = 0;
};

}  // namespace rths::controller

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "motion.hpp"
#include "trial_case.hpp"

namespace trial {

/// What of an effect shows in one record, in units of the noise that hides it.
///
/// Every signal is that of both axes, the lateral one behind the longitudinal one, at kCompareRate.
class Observer {
 public:
  /// Of a force the noise is that of the load cell and what the noise of the motion makes of the
  /// bearing's force: its size follows the stiffness in time, its colour is autoregressive. Of
  /// displacement and acceleration it is the noise of the one against the other.
  Observer(const TrialCase& trial, std::size_t record, Relation relation);

  /// What would be seen at the same motion under that physics, whitened.
  [[nodiscard]] Signal seen(const Physics& physics) const;

  /// Difference of the record to one with the usual resolution and no samples lost, whitened.
  [[nodiscard]] Signal seen_of_recorder() const;

  [[nodiscard]] const Record& record() const { return record_; }

 private:
  static constexpr std::size_t kOrder = 4;
  struct Whitener {
    Signal deviation;
    std::array<double, kOrder> keeps{};
    double scale = 1;
  };

  void learn_force_noise(const Physics& physics);
  [[nodiscard]] Signal whitened_force(const std::vector<Plane>& force, double sample_time) const;
  [[nodiscard]] Signal whitened(const std::vector<Plane>& motion) const;
  [[nodiscard]] double density(double frequency_Hz) const;

  const Record& record_;
  ChannelNoise noise_;
  Relation relation_;
  Motion motion_;
  std::array<Whitener, 2> whitener_;
};

}  // namespace trial

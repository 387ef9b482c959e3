// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "motion.hpp"
#include "trial_case.hpp"

namespace trial {

/// The visible signal of an effect in one record, in units of the noise.
///
/// Every signal holds the longitudinal axis, then the lateral one, at kCompareRate.
class Observer {
 public:
  /// The noise of a force is that of the load cell plus the effect of motion noise on the bearing's
  /// force: its size follows the stiffness over time, its colour is autoregressive. The noise of
  /// displacement and acceleration is that of their difference.
  Observer(const TrialCase& trial, std::size_t record, Relation relation);

  /// Returns the whitened signal under that physics and the same motion.
  [[nodiscard]] Signal seen(const Physics& physics) const;

  /// Returns the whitened difference between the record and one with the default resolution and no
  /// lost samples.
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

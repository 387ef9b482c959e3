// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/loop/numerical_response.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/structure_model.hpp>

namespace rths::budget {

/// A simulation whose specimen has uncertain parameters.
struct UncertainSimulation {
  std::shared_ptr<const sim::StructureModel> structure;
  sim::GroundMotion motion;
  double time_step = 0.001, duration = 0;  ///< [s]
  sim::Bearing fitted;
  /// The specimen one standard deviation away from the fitted one, in both senses along each of the
  /// independent directions of its parameters: two for each.
  std::vector<sim::Bearing> deviating;
  /// The part of the measured force that the fitted model and noise leave, one sample per step of
  /// the simulation; may be shorter. Empty: none is known.
  loop::AddedForce remainder;
};

/// A peak of the response: of the absolute value, over the whole time.
struct PeakBand {
  std::string name;  ///< "displacement.long", "force.lat"
  std::string unit;
  double value = 0, low = 0, high = 0;  ///< of the fitted specimen; 95 % interval
};

/// Spectrum of the accelerations of a floor, of both directions together. [m/s²]
struct SpectrumBand {
  std::string floor;
  std::vector<double> value, low, high;  ///< by frequency
};

/// Peaks and floor spectra of a simulation with their 95 % intervals.
struct ResponseBands {
  std::vector<PeakBand> peaks;
  std::vector<double> frequencies;  ///< [Hz]
  double damping_ratio = 0;         ///< of the spectra [-]
  std::vector<SpectrumBand> spectra;
  int runs = 0;                ///< simulations
  bool has_remainder = false;  ///< it is counted

  [[nodiscard]] bool is_empty() const { return peaks.empty(); }
};

/// Carries uncertainty to the response, by simulations: one with the fitted specimen, one with each
/// deviating one, eight with the remainder as an added force. Variances add up:
///
///     σ² = ½ Σᵢ (yᵢ − y)² + ⅛ Σₖ (yₖ − y)²
///
/// The remainder has no place in a motion that differs from that of the test; so each of the eight
/// begins it at another instant, every other one with the opposite sign. Without random numbers.
/// One simulation runs on each processor at a time.
/// @throws Error if a simulation diverges   @setup
[[nodiscard]] ResponseBands response_bands(const UncertainSimulation& simulation);

}  // namespace rths::budget

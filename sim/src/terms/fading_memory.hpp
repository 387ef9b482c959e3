// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rths::sim {

// What a body remembers of a flux that fades with a power of time:
//     M(t) = ∫₀ᵗ q(t − s) s^(−p) ds,  0 < p < 1
// The kernel is a sum of decaying exponentials with non-negative weights (docs/theory/sliding.md),
// so that each remembers all of the past in one number. The kernel's singular part lies in the
// present step and is integrated exactly there: the flux is constant within a step.

/// weight · e^(−rate t)
struct FadingExponential {
  double rate;    ///< [1/s]
  double weight;  ///< [s^-p], ≥ 0
};

inline constexpr std::size_t kFadingExponentials = 24;
inline constexpr std::size_t kFadingStates = kFadingExponentials;
inline constexpr std::size_t kFadingConstants = 1 + 2 * kFadingExponentials;
inline constexpr double kLongestMemory =
    600;  ///< beyond it, memory fades faster than it should [s]

/// Exponentials whose sum is t^(−p) between two times: to 0.05 % for p ≥ 0.1 and times that lie a
/// factor of up to 6e6 apart. Their number is kFadingExponentials; some weights may be 0.
/// @param power  0 < p < 1
/// @setup
[[nodiscard]] std::vector<FadingExponential> fading_exponentials(double power, double shortest,
                                                                 double longest);

/// Constants of `remember` for a time step [s].
/// @param constants  of length kFadingConstants
/// @setup
void prepare_fading_memory(double power, double time_step, std::span<double> constants);

/// One step: M at its end, for a flux that was `flux` all along it.
/// @param constants  made by `prepare_fading_memory`
/// @param memory     of length kFadingStates, zeros when nothing has happened yet   @realtime
template <class Real>
[[nodiscard]] Real remember(const double* constants, Real* memory, const Real& flux) noexcept {
  const double* decay = constants + 1;
  const double* intake = decay + kFadingExponentials;
  Real sum = flux * constants[0];
  for (std::size_t i = 0; i < kFadingExponentials; ++i) {
    sum += memory[i];
    memory[i] = memory[i] * decay[i] + flux * intake[i];
  }
  return sum;
}

}  // namespace rths::sim

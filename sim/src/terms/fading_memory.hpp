// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rths::sim {

// Memory of a flux that fades with a power of time:
//     M(t) = ∫₀ᵗ q(t − s) s^(−p) ds,  0 < p < 1
// The kernel is a sum of decaying exponentials with non-negative weights (docs/theory/sliding.md);
// each stores its whole history in one number. The kernel's singularity lies in the present step
// and is integrated exactly there, for a flux constant within the step.

/// weight · e^(−rate t)
struct FadingExponential {
  double rate;    ///< [1/s]
  double weight;  ///< [s^-p], ≥ 0
};

inline constexpr std::size_t kFadingExponentials = 24;
inline constexpr std::size_t kFadingStates = kFadingExponentials;
inline constexpr std::size_t kFadingConstants = 1 + 2 * kFadingExponentials;
inline constexpr double kLongestMemory =
    600;  ///< beyond it, the memory fades faster than the power law [s]

/// Exponentials whose sum is t^(−p) between two times: within 0.05 % for p ≥ 0.1 and a ratio of the
/// times up to 6e6. Their number is kFadingExponentials; some weights may be 0.
/// @param power  0 < p < 1
/// @setup
[[nodiscard]] std::vector<FadingExponential> fading_exponentials(double power, double shortest,
                                                                 double longest);

/// Constants of `remember` for a time step [s].
/// @param constants  of length kFadingConstants
/// @setup
void prepare_fading_memory(double power, double time_step, std::span<double> constants);

/// Returns M at the end of one step of constant flux.
/// @param constants  made by `prepare_fading_memory`
/// @param memory     of length kFadingStates, initially zeros   @realtime
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

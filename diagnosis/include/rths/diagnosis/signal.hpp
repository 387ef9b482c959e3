// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace rths::diagnosis {

/// Low-pass without phase: a Butterworth filter forwards and backwards, so that its gain counts
/// twice. The ends are continued by their odd reflection.
/// @param order  of one pass: 2, 4, 6 or 8
/// @param cutoff  where one pass has 1/√2 [Hz], below half the sampling rate
/// @param time_step  [s]
/// @throws Error if one is out of range, or the signal has fewer than 2 samples   @setup
[[nodiscard]] Eigen::VectorXd low_passed(const Eigen::VectorXd& signal, int order, double cutoff,
                                         double time_step);

/// Every `factor`-th sample, from the first on. No filter: low-pass before.   @setup
[[nodiscard]] Eigen::VectorXd thinned(const Eigen::VectorXd& signal, int factor);

/// Rate of change by differences of fourth order; of second order and first next to the ends.
/// @setup
[[nodiscard]] Eigen::VectorXd rate_of(const Eigen::VectorXd& signal, double time_step);

/// Rate of change of the rate of change, likewise; zero at the ends.   @setup
[[nodiscard]] Eigen::VectorXd second_rate_of(const Eigen::VectorXd& signal, double time_step);

/// Displacement that takes its slow part from a displacement and its fast part from an
/// acceleration, without phase:
///     U_f = U (1 − H) − A H/(2πf)²,   H = f⁴/(f⁴ + f_c⁴)
/// Both begin at rest, at zero.
/// @param crossover  f_c [Hz]
/// @returns [m]
/// @throws Error if the lengths differ   @setup
[[nodiscard]] Eigen::VectorXd fused(const Eigen::VectorXd& displacement,
                                    const Eigen::VectorXd& acceleration, double crossover,
                                    double time_step);

/// x(t) = Σ aᵢ x(t − i) + e(t): how noise remembers itself.
struct AutoRegression {
  Eigen::VectorXd coefficients;  ///< a₁ … aₙ
  double deviation = 0;          ///< of e, the innovation

  /// The innovations of a signal over `deviation`: white, of variance 1, if the model holds. The
  /// first samples take what came before them for zero.
  [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& signal) const;
  /// A signal made of unit innovations.
  [[nodiscard]] Eigen::VectorXd coloured(const Eigen::VectorXd& innovations) const;
};

/// Burg's method (1975), which holds where the spectrum spans many decades, with the means taken
/// out. Several stretches of one process may be given.
/// @param ridge  added to the variance, as a part of it: keeps a short stretch from over-fitting
/// @throws Error if there are fewer samples than twice the order   @setup
[[nodiscard]] AutoRegression auto_regression(const std::vector<Eigen::VectorXd>& stretches,
                                             int order, double ridge = 1e-9);

/// Power spectral density, one-sided: mean over half-overlapping Hann windows (Welch 1967).
struct Spectrum {
  Eigen::VectorXd frequency;  ///< [Hz]
  Eigen::VectorXd density;    ///< [unit²/Hz]
};
/// @param window  samples, a power of two   @throws Error if the signal is shorter   @setup
[[nodiscard]] Spectrum power_spectrum(const Eigen::VectorXd& signal, int window, double time_step);

/// Spectral density of short stretches of one process, in bands that widen with frequency: fine
/// enough for drift, smooth enough for hiss. Below the first band it rises on as 1/f, up to
/// threefold.
class NoiseSpectrum {
 public:
  NoiseSpectrum() = default;
  /// White noise of that standard deviation.
  NoiseSpectrum(double deviation, double time_step);
  /// Hann windows, means taken out. @throws Error if the stretches are shorter than 16 samples
  NoiseSpectrum(const std::vector<Eigen::VectorXd>& stretches, double time_step);

  [[nodiscard]] double density(double frequency) const;  ///< one-sided [unit²/Hz]
  /// Draws signals of Gaussian noise, of one length: what they have in common is worked out once.
  class Generator {
   public:
    /// @param random  gives standard normal numbers
    [[nodiscard]] Eigen::VectorXd draw(const std::function<double()>& random) const;

   private:
    friend class NoiseSpectrum;
    Eigen::Index samples_ = 0, length_ = 0;
    Eigen::VectorXd size_;  // of bins from the first on; empty: no noise
  };
  [[nodiscard]] Generator generator(Eigen::Index samples, double time_step) const;
  [[nodiscard]] bool is_nothing() const;
  [[nodiscard]] NoiseSpectrum scaled(double factor) const;  ///< of the signal times a factor

 private:
  std::vector<double> frequency_, density_;  ///< of bands [Hz], [unit²/Hz]
};

}  // namespace rths::diagnosis

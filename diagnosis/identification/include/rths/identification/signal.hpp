// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// Zero-phase low-pass: a Butterworth filter forwards and backwards, so its gain applies twice. The
/// ends are extended by their odd reflection.
/// @param order  of one pass: 2, 4, 6 or 8
/// @param cutoff  frequency at which one pass has gain 1/√2 [Hz], below half the sampling rate
/// @param time_step  [s]
/// @throws Error if a parameter is out of range, or the signal has fewer than 2 samples   @setup
[[nodiscard]] VectorXd low_passed(const VectorXd& signal, int order, double cutoff,
                                  double time_step);

/// The same of each column, four at a time.   @setup
[[nodiscard]] MatrixXd low_passed_columns(const MatrixXd& signals, int order, double cutoff,
                                          double time_step);

/// Every `factor`-th sample, from the first on. Does not filter: low-pass the signal first. @setup
[[nodiscard]] VectorXd thinned(const VectorXd& signal, int factor);

/// Rate of change by differences of fourth order; near the ends of second and first order.   @setup
[[nodiscard]] VectorXd rate_of(const VectorXd& signal, double time_step);

/// Second rate of change by differences; zero at the ends.   @setup
[[nodiscard]] VectorXd second_rate_of(const VectorXd& signal, double time_step);

/// Zero-phase fusion of displacement at low frequencies and acceleration at high frequencies:
///     U_f = U (1 − H) − A H/(2πf)²,   H = f⁴/(f⁴ + f_c⁴)
/// A record may begin and end in motion.
/// @param crossover  f_c [Hz]
/// @returns [m]
/// @throws Error if the lengths differ   @setup
[[nodiscard]] VectorXd fused(const VectorXd& displacement, const VectorXd& acceleration,
                             double crossover, double time_step);

/// Autoregressive model of noise: x(t) = Σ aᵢ x(t − i) + e(t).
struct AutoRegression {
  VectorXd coefficients;  ///< a₁ … aₙ
  double deviation = 0;   ///< of e, the innovation

  /// The innovations of a signal divided by `deviation`: white, of variance 1, if the model holds.
  /// Samples before the first count as zero.
  [[nodiscard]] VectorXd whitened(const VectorXd& signal) const;
  /// The signal with these unit innovations.
  [[nodiscard]] VectorXd coloured(const VectorXd& innovations) const;
};

/// Fits by Burg's method (1975), which works for spectra that span many decades. Removes the means.
/// @param stretches  of one process
/// @param ridge  relative addition to the variance: prevents overfitting of a short stretch
/// @throws Error if there are fewer samples than twice the order   @setup
[[nodiscard]] AutoRegression auto_regression(const std::vector<VectorXd>& stretches, int order,
                                             double ridge = 1e-9);

/// Power spectral density, one-sided: mean over half-overlapping Hann windows (Welch 1967).
struct Spectrum {
  VectorXd frequency;  ///< [Hz]
  VectorXd density;    ///< [unit²/Hz]
};
/// @param window  samples, a power of two   @throws Error if the signal is shorter   @setup
[[nodiscard]] Spectrum power_spectrum(const VectorXd& signal, int window, double time_step);

/// The frequency from which on signals are noise: no third of an octave above it has twice the
/// density, in the sum over all signals, that they have at rest. The Nyquist frequency if there is
/// none [Hz].   @setup
[[nodiscard]] double noise_begins(const std::vector<VectorXd>& signals,
                                  const std::vector<VectorXd>& at_rest, double time_step);

/// Successive samples.
struct Stretch {
  VectorXd samples;
  double time_step = 0;  ///< [s]
};

/// Spectral density of short stretches of one process, in bands that widen with frequency. Narrow
/// low bands resolve drift; wide high bands smooth broadband noise. Below the first band the
/// density rises as 1/f, up to threefold.
class NoiseSpectrum {
 public:
  NoiseSpectrum() = default;
  /// White noise of this standard deviation.
  NoiseSpectrum(double deviation, double time_step);
  /// Hann windows, means removed. Stretches of different time steps share the bands below the
  /// Nyquist frequency of both. @throws Error if the stretches are shorter than 16 samples
  explicit NoiseSpectrum(const std::vector<Stretch>& stretches);

  [[nodiscard]] double density(double frequency) const;          ///< one-sided [unit²/Hz]
  [[nodiscard]] double deviation() const { return deviation_; }  ///< standard [unit]
  /// Generates Gaussian noise signals of one length; precomputes their amplitudes.
  class Generator {
   public:
    /// @param random  returns standard normal numbers
    [[nodiscard]] VectorXd draw(const std::function<double()>& random) const;

   private:
    friend class NoiseSpectrum;
    Index samples_ = 0, length_ = 0;
    VectorXd size_;  // of bins from the first on; empty: no noise
  };
  [[nodiscard]] Generator generator(Index samples, double time_step) const;
  [[nodiscard]] bool is_nothing() const;
  [[nodiscard]] NoiseSpectrum scaled(double factor) const;  ///< of the signal times a factor

 private:
  std::vector<double> frequency_, density_;  ///< of bands [Hz], [unit²/Hz]
  double deviation_ = 0;
  double slope_ = 0;       ///< exponent of the density's rise below the lowest band
  bool is_smooth_ = true;  ///< no lines stand out of the density
};

}  // namespace rths::diagnosis

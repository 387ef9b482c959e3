// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace rths::diagnosis {

/// Zero-phase low-pass: a Butterworth filter forwards and backwards, so its gain applies twice. The
/// ends are extended by their odd reflection.
/// @param order  of one pass: 2, 4, 6 or 8
/// @param cutoff  frequency at which one pass has gain 1/√2 [Hz], below half the sampling rate
/// @param time_step  [s]
/// @throws Error if a parameter is out of range, or the signal has fewer than 2 samples   @setup
[[nodiscard]] Eigen::VectorXd low_passed(const Eigen::VectorXd& signal, int order, double cutoff,
                                         double time_step);

/// The same of each column, four at a time.   @setup
[[nodiscard]] Eigen::MatrixXd low_passed_columns(const Eigen::MatrixXd& signals, int order,
                                                 double cutoff, double time_step);

/// Every `factor`-th sample, from the first on. Does not filter: low-pass the signal first. @setup
[[nodiscard]] Eigen::VectorXd thinned(const Eigen::VectorXd& signal, int factor);

/// Rate of change by differences of fourth order; near the ends of second and first order.   @setup
[[nodiscard]] Eigen::VectorXd rate_of(const Eigen::VectorXd& signal, double time_step);

/// Second rate of change by differences; zero at the ends.   @setup
[[nodiscard]] Eigen::VectorXd second_rate_of(const Eigen::VectorXd& signal, double time_step);

/// Zero-phase fusion of displacement at low frequencies and acceleration at high frequencies:
///     U_f = U (1 − H) − A H/(2πf)²,   H = f⁴/(f⁴ + f_c⁴)
/// A record may begin and end in motion.
/// @param crossover  f_c [Hz]
/// @returns [m]
/// @throws Error if the lengths differ   @setup
[[nodiscard]] Eigen::VectorXd fused(const Eigen::VectorXd& displacement,
                                    const Eigen::VectorXd& acceleration, double crossover,
                                    double time_step);

/// Autoregressive model of noise: x(t) = Σ aᵢ x(t − i) + e(t).
struct AutoRegression {
  Eigen::VectorXd coefficients;  ///< a₁ … aₙ
  double deviation = 0;          ///< of e, the innovation

  /// The innovations of a signal divided by `deviation`: white, of variance 1, if the model holds.
  /// Samples before the first count as zero.
  [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& signal) const;
  /// The signal with these unit innovations.
  [[nodiscard]] Eigen::VectorXd coloured(const Eigen::VectorXd& innovations) const;
};

/// Fits by Burg's method (1975), which works for spectra that span many decades. Removes the means.
/// @param stretches  of one process
/// @param ridge  relative addition to the variance: prevents overfitting of a short stretch
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

/// The frequency from which on signals are noise: no third of an octave above it has twice the
/// density, in the sum over all signals, that they have at rest. The Nyquist frequency if there is
/// none [Hz].   @setup
[[nodiscard]] double noise_begins(const std::vector<Eigen::VectorXd>& signals,
                                  const std::vector<Eigen::VectorXd>& at_rest, double time_step);

/// Successive samples.
struct Stretch {
  Eigen::VectorXd samples;
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
  double deviation_ = 0;
  double slope_ = 0;       ///< exponent of the density's rise below the lowest band
  bool is_smooth_ = true;  ///< no lines stand out of the density
};

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include <rths/identification/record.hpp>
#include <rths/identification/relation.hpp>
#include <rths/identification/signal.hpp>

namespace rths::diagnosis {

/// Draws records that contain only noise, as long as a given record.
class NoiseGenerator {
 public:
  [[nodiscard]] Record draw(std::mt19937_64& random) const;

 private:
  friend class SensorNoise;
  struct Drawn {
    NoiseSpectrum::Generator generator;
    std::vector<double> white;  ///< standard deviations of added white noise
  };
  Record empty_;
  std::vector<Drawn> drawn_;  ///< of every channel
};

/// Noise of the sensors, channel by channel.
class SensorNoise {
 public:
  /// Estimates the noise from quiet intervals and reference records; else takes the deviations in
  /// case.toml; else estimates it from differences between samples that motion cannot cause.
  /// Estimated noise has one spectral density per Hz at every sampling rate; stated noise is white
  /// and has its deviation at every rate.
  /// @param added  white noise that is present only in motion, by role: rounding
  SensorNoise(const std::vector<const Record*>& records,
              const std::vector<std::pair<std::string, double>>& stated,
              const std::vector<std::pair<std::string, double>>& added = {});

  [[nodiscard]] NoiseGenerator generator_like(const Record& record) const;
  /// Whether the noise was recorded at rest: only then its colour is known.
  [[nodiscard]] bool was_seen_at_rest() const { return was_seen_at_rest_; }
  /// Whether the noise of every channel is known: measured at rest, stated, or guessed as a small
  /// part of the channel. A channel whose noise is not known counts as exact.
  [[nodiscard]] bool is_known() const { return unknown_.empty(); }
  /// Roles of the channels whose noise is not known.
  [[nodiscard]] const std::vector<std::string>& unknown() const { return unknown_; }
  /// Largest standard deviation of a family's sensors, "displacement"; 0: none was recorded.
  [[nodiscard]] double deviation(const std::string& family) const;
  [[nodiscard]] const std::string& source() const { return source_; }  ///< for the limits
  /// Sines at rest that are no noise: "force.long has a sine of 2.10 Hz at rest".
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::map<std::string, NoiseSpectrum> by_role_;
  std::map<std::string, double> stated_;  ///< deviations, where the noise was not seen at rest
  std::vector<std::pair<std::string, double>> added_;
  bool was_seen_at_rest_ = false;
  std::string source_;
  std::vector<std::string> lines_, unknown_;
};

/// Noise whose size and colour change slowly. A bearing, for example, turns the same motion error
/// into a larger force error while it is stiff than while it yields.
class VaryingNoise {
 public:
  VaryingNoise() = default;
  /// White noise of constant size.
  VaryingNoise(Index rows, double deviation);
  /// @param draws  of the noise, of equal length   @param half  half width of smoothing [rows]
  /// @param piece  rows of one colour              @param least  smallest size
  VaryingNoise(const std::vector<VectorXd>& draws, Index half, Index piece, double least);

  /// Noise → white numbers of variance 1.
  [[nodiscard]] VectorXd whitened(const VectorXd& noise) const;
  /// Constant noise, as in the piece of median size.
  [[nodiscard]] VaryingNoise steady(Index rows) const;
  void grow(double factor) { deviation_ *= factor; }
  [[nodiscard]] const VectorXd& deviation() const { return deviation_; }
  [[nodiscard]] Index order() const;
  /// Mean logarithm of the divisor of whitening.
  [[nodiscard]] double log_size() const;

 private:
  VectorXd deviation_;
  Index piece_ = 1;
  std::vector<AutoRegression> colours_;  ///< of every piece
};

/// Noise of the sensors in the residual of a relation on one record. Its size varies in time,
/// because a stiff specimen turns the same motion error into a larger force error than a soft one.
class ResidualNoise {
 public:
  /// @param draws  residuals due to noise alone, rows × outputs each
  /// @param has_colour  false: whitening only divides by the size
  ResidualNoise(const std::vector<MatrixXd>& draws, const Drive& drive, bool has_colour);

  /// The same noise at its median size, for a test that was not run yet.
  [[nodiscard]] ResidualNoise steady(const Drive& drive) const;

  /// Residual → numbers that are white, of variance 1, if it is noise. Rows before
  /// Drive::first_row are zero.
  [[nodiscard]] MatrixXd whitened(const MatrixXd& residual) const;
  /// Of one output.
  [[nodiscard]] VectorXd whitened(const VectorXd& residual, Index output) const;
  /// Rows × outputs.
  [[nodiscard]] MatrixXd deviation() const;
  /// Mean logarithm of the divisor of residuals: the level of the noise.
  [[nodiscard]] double log_size() const;

 private:
  std::vector<VaryingNoise> outputs_;
  Index first_row_ = 0;
};

}  // namespace rths::diagnosis

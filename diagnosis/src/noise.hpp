// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include <rths/diagnosis/case.hpp>
#include <rths/diagnosis/signal.hpp>

#include "relation.hpp"

namespace rths::diagnosis {

/// Draws records of noise alone, of the length of another.
class NoiseGenerator {
 public:
  [[nodiscard]] Record draw(std::mt19937_64& random) const;

 private:
  friend class SensorNoise;
  struct Drawn {
    NoiseSpectrum::Generator generator;
    std::vector<double> white;  ///< deviations of what is added
  };
  Record empty_;
  std::vector<Drawn> drawn_;  ///< of every channel
};

/// What the sensors add to what they measure, channel by channel.
class SensorNoise {
 public:
  /// From the best there is: quiet stretches and reference records, what case.toml states, else
  /// what a signal cannot have done from one sample to the next.
  /// @param added  white noise that shows only in motion, by role: rounding
  SensorNoise(const std::vector<const Record*>& records,
              const std::vector<std::pair<std::string, double>>& stated,
              const std::vector<std::pair<std::string, double>>& added = {});

  [[nodiscard]] NoiseGenerator generator_like(const Record& record) const;
  /// Whether it was seen at rest: only then its colour is known.
  [[nodiscard]] bool was_seen_at_rest() const { return was_seen_at_rest_; }
  [[nodiscard]] const std::string& source() const { return source_; }  ///< for the limits

 private:
  std::map<std::string, NoiseSpectrum> by_role_;
  std::vector<std::pair<std::string, double>> added_;
  bool was_seen_at_rest_ = false;
  std::string source_;
};

/// Noise whose size and colour change slowly: what makes more of an error in its motion while it is
/// stiff than while it flows.
class VaryingNoise {
 public:
  VaryingNoise() = default;
  /// White, of one size.
  VaryingNoise(Eigen::Index rows, double deviation);
  /// @param draws  of the noise, of equal length   @param half  rows that sizes are smoothed over
  /// @param piece  rows of one colour              @param least  size
  VaryingNoise(const std::vector<Eigen::VectorXd>& draws, Eigen::Index half, Eigen::Index piece,
               double least);

  /// Noise → white numbers of variance 1.
  [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& noise) const;
  /// As it is in the piece of median size, throughout.
  [[nodiscard]] VaryingNoise steady(Eigen::Index rows) const;
  void grow(double factor) { deviation_ *= factor; }
  [[nodiscard]] const Eigen::VectorXd& deviation() const { return deviation_; }
  [[nodiscard]] Eigen::Index order() const;
  /// Mean of ln of what is divided by.
  [[nodiscard]] double log_size() const;

 private:
  Eigen::VectorXd deviation_;
  Eigen::Index piece_ = 1;
  std::vector<AutoRegression> colours_;  ///< of every piece
};

/// How the noise of the sensors shows in the residual of a relation on one record: its size varies
/// in time, for a stiff part makes more of an error in its motion than a soft one.
class ResidualNoise {
 public:
  /// @param draws  residuals that noise alone makes, rows × outputs each
  /// @param has_colour  whether they may be whitened by more than their size
  ResidualNoise(const std::vector<Eigen::MatrixXd>& draws, const Drive& drive, bool has_colour);

  /// The same noise at its median size, for a record that was not recorded yet.
  [[nodiscard]] ResidualNoise steady(const Drive& drive) const;

  /// Residual → numbers that are white, of variance 1, if it is noise. Rows before
  /// Drive::first_row are zero.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& residual) const;
  /// Of one output.
  [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& residual,
                                         Eigen::Index output) const;
  /// Rows × outputs.
  [[nodiscard]] Eigen::MatrixXd deviation() const;
  /// Mean of ln of what residuals are divided by: how much noise there is.
  [[nodiscard]] double log_size() const;

 private:
  std::vector<VaryingNoise> outputs_;
  Eigen::Index first_row_ = 0;
};

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// A measured or predicted quantity, named by its role: "displacement.long", "input.voltage".
struct Channel {
  std::string role;
  std::string unit;            ///< SI
  std::vector<double> values;  ///< [unit]
};

/// The first part of a role: "displacement" of "displacement.long".
[[nodiscard]] std::string family_of(std::string_view role);

/// Begins the role of a channel that a simulation predicted: "predicted.force.long".
inline constexpr std::string_view kPredicted = "predicted.";
[[nodiscard]] bool is_predicted(std::string_view role);
/// The role of the prediction of a channel.
[[nodiscard]] std::string prediction_of(std::string_view role);
/// Whether a sensor measured the channel: commands, inputs, predictions and auxiliary channels
/// count as exact.
[[nodiscard]] bool is_measured(std::string_view role);

/// Purpose of a record.
enum class Use {
  Fit,       ///< parameters are fitted to it
  HeldOut,   ///< the fitted model is tested on it
  Reference  ///< no motion: gives the noise
};

/// "fit", "held_out", "reference"
[[nodiscard]] std::string name_of(Use use);

/// One recording: channels of equal length, equally spaced in time. The records of a case may have
/// different sampling rates. A quasi-static test may have rows without time: its times are then
/// numbers of rows, from 1 on, one apart.
struct Record {
  std::string name;  ///< unique in its case; default: name of its file
  Use use = Use::Fit;
  double start = 0;      ///< time of the first sample, on the file's clock [s]
  double time_step = 0;  ///< [s]
  double settle = 0;     ///< excluded from the comparison at the start: earlier motion matters [s]
  std::vector<Channel> channels;
  std::optional<std::pair<std::size_t, std::size_t>> quiet;  ///< samples without motion
  /// Samples, from the last known one to the next, between which the values are interpolated and
  /// not compared.
  // NOLINTNEXTLINE(readability-redundant-member-init): initializers may leave it out
  std::vector<std::pair<std::size_t, std::size_t>> gaps = {};
  bool has_time = true;

  [[nodiscard]] std::size_t samples() const;
  /// The channel of a role; null if it was not recorded.
  [[nodiscard]] const Channel* find(const std::string& role) const;
};

/// The samples of a channel [its unit].
[[nodiscard]] VectorXd values_of(const Channel& channel);

}  // namespace rths::diagnosis

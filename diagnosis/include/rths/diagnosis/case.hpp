// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>

namespace rths::diagnosis {

/// Version of the format of case.toml. Increased when a valid file would change its meaning or no
/// longer load.
inline constexpr int kCaseFormat = 1;

/// A measured or predicted quantity, named by its role: "displacement.long", "input.voltage".
struct Channel {
  std::string role;
  std::string unit;            ///< SI
  std::vector<double> values;  ///< [unit]
};

/// Purpose of a record.
enum class Use {
  Fit,       ///< parameters are fitted to it
  HeldOut,   ///< the fitted model is tested on it
  Reference  ///< an empty table, or no motion: gives the noise
};

/// One recording: channels of equal length, equally spaced in time. The records of a case may have
/// different sampling rates.
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

  [[nodiscard]] std::size_t samples() const;
  /// The channel of a role; null if it was not recorded.
  [[nodiscard]] const Channel* find(const std::string& role) const;
};

/// A parameter of the model that was fitted and may be fitted again.
struct FittedParameter {
  std::string name;                                 ///< "term.parameter"
  std::optional<std::pair<double, double>> bounds;  ///< [SI]; none: the term's
};

/// The model of the simulation.
struct Model {
  std::string kind =
      "data";    ///< bearing, platen, servo_axis, structure, mass_spring_damper, linear
  Config table;  ///< the table [model]: terms, matrices and other data of the kind
  std::vector<FittedParameter> fitted;
};

/// Range of the map of states, from −x to x; none: the range of the recordings.
struct MapRange {
  std::optional<double> displacement;  ///< [m]
  std::optional<double> velocity;      ///< [m/s]
};

/// Rate of the model and bandwidth of the comparison; none: values for a bearing in an earthquake.
struct Comparison {
  std::optional<double> model_rate;  ///< upper limit, besides the record's sampling rate [Hz]
  std::optional<double> cutoff;      ///< of the filter on prediction and measurement [Hz]
};

/// Recordings, and a model that does not explain them.
struct Case {
  std::string name;
  std::filesystem::path folder;
  std::vector<Record> records;  ///< in the order of case.toml
  Model model;
  MapRange map;
  Comparison comparison;
  std::vector<std::pair<std::string, double>> noise;  ///< standard deviation by role [SI]
};

/// File of the recording of a second earthquake, in the folder of a run.
inline constexpr const char* kHeldOutFile = "held_out.h5";

/// Reads case.toml of a folder, or another case file (*.toml), and its recordings. The path may
/// also be the recording of a run (run.h5): it contains the model of the simulation. A recording of
/// a second earthquake in the same folder is read too.
/// @throws Error file:line:column, found and expected   @setup
[[nodiscard]] Case load_case(const std::filesystem::path& path);

}  // namespace rths::diagnosis

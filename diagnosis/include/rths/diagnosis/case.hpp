// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>

namespace rths::diagnosis {

/// Version of the format of case.toml. Bumped when a file that was right before would mean
/// something else, or no longer load.
inline constexpr int kCaseFormat = 1;

/// What was measured, or predicted, by the role it plays: "displacement.long", "input.voltage".
struct Channel {
  std::string role;
  std::string unit;            ///< SI
  std::vector<double> values;  ///< [unit]
};

/// What a record is for.
enum class Use {
  Fit,       ///< parameters are found on it
  HeldOut,   ///< and proven on it
  Reference  ///< an empty table, or nothing moving: tells the noise
};

/// One recording: channels of equal length, equally spaced in time. The records of a case may have
/// been sampled at different rates.
struct Record {
  std::string name;  ///< that of its file if it was given none; no other record has it
  Use use = Use::Fit;
  double start = 0;      ///< time of the first sample, by the file's clock [s]
  double time_step = 0;  ///< [s]
  double settle = 0;  ///< how long from the start what came before it is still felt: not compared
                      ///< [s]
  std::vector<Channel> channels;
  std::optional<std::pair<std::size_t, std::size_t>> quiet;  ///< samples in which nothing moves

  [[nodiscard]] std::size_t samples() const;
  /// The channel of a role, null if it was not recorded.
  [[nodiscard]] const Channel* find(const std::string& role) const;
};

/// A parameter of the model that was fitted, and may be fitted again.
struct FittedParameter {
  std::string name;                                 ///< "term.parameter"
  std::optional<std::pair<double, double>> bounds;  ///< [SI]; none: those of the term
};

/// What the simulation assumed.
struct Model {
  std::string kind =
      "data";    ///< bearing, platen, servo_axis, structure, mass_spring_damper, linear
  Config table;  ///< [model] as it stands: terms, matrices, whatever the kind needs
  std::vector<FittedParameter> fitted;
};

/// How far the map of states reaches, from −x to x; nothing: as far as the recordings go.
struct MapRange {
  std::optional<double> displacement;  ///< [m]
  std::optional<double> velocity;      ///< [m/s]
};

/// At what rate the model runs and up to which frequency it is compared; nothing: what suits a
/// bearing in an earthquake.
struct Comparison {
  std::optional<double>
      model_rate;                ///< at most; a case is never run faster than it was sampled [Hz]
  std::optional<double> cutoff;  ///< of the filter that model and measurement take [Hz]
};

/// A recording and a model that does not explain it.
struct Case {
  std::string name;
  std::filesystem::path folder;
  std::vector<Record> records;  ///< as case.toml lists them
  Model model;
  MapRange map;
  Comparison comparison;
  std::vector<std::pair<std::string, double>> noise;  ///< standard deviation by role [SI]
};

/// The recording of a second earthquake, beside that of a run.
inline constexpr const char* kHeldOutFile = "held_out.h5";

/// Reads case.toml of a folder and the recordings it names; or the recording of a run (run.h5),
/// which holds what the simulation assumed, with that of a second earthquake beside it if there is
/// one.
/// @throws Error file:line:column, what was found and what was expected   @setup
[[nodiscard]] Case load_case(const std::filesystem::path& folder_or_run);

}  // namespace rths::diagnosis

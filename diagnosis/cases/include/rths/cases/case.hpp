// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rths/core/config.hpp>
#include <rths/identification/record.hpp>

namespace rths::diagnosis {

/// Version of the format of case.toml. Increased when a valid file would change its meaning or no
/// longer load.
inline constexpr int kCaseFormat = 1;

/// A parameter of the model that was fitted and may be fitted again.
struct FittedParameter {
  std::string name;                                 ///< "term.parameter"
  std::optional<std::pair<double, double>> bounds;  ///< [SI]; none: the term's
};

enum class ModelKind {
  Bearing,
  Platen,
  ServoAxis,
  Structure,
  MassSpringDamper,
  Linear,
  Data,
  Program,
  OpenSees,
  Fmu,
  Plugin
};

/// As in a case: "servo_axis".
[[nodiscard]] std::string name_of(ModelKind kind);
/// Whether a kind of model consists of terms of the catalogue: bearing, platen, servo axis.
[[nodiscard]] bool is_composition(ModelKind kind);
/// Whether a kind of model is the user's own simulation, which runs during a diagnosis.
[[nodiscard]] bool is_foreign(ModelKind kind);
/// Whether a kind of model is the user's own prediction: data, or a simulation that makes them.
[[nodiscard]] bool is_prediction(ModelKind kind);

/// The model of the simulation.
struct Model {
  ModelKind kind = ModelKind::Data;
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

/// The files from which a case was read, for an improved case; empty if it was made in memory.
struct CaseSource {
  Config file;                   ///< case.toml; of a run: `run` and the model
  std::filesystem::path folder;  ///< where relative paths of `file` start
  Config experiment;             ///< of a run whose experiment file still exists, with changes
  std::filesystem::path experiment_folder;  ///< where relative paths of `experiment` start
  /// The laboratory of `experiment` is the improved simulation itself.
  bool has_improved_laboratory = false;
  /// Everything that was read: the case file, recordings, predictions, files that these name.
  std::vector<std::filesystem::path> inputs;
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
  // NOLINTNEXTLINE(readability-redundant-member-init): initializers may leave it out
  CaseSource source = {};
};

/// File of the recording of a second earthquake, in the folder of a run.
inline constexpr const char* kHeldOutFile = "held_out.h5";

/// Records for fitting and proof, without reference records.
[[nodiscard]] std::vector<const Record*> moving_records(const Case& c);

/// Reads case.toml of a folder, or another case file (*.toml), and its recordings. The path may
/// also be the recording of a run (run.h5): it contains the model of the simulation. A recording of
/// a second earthquake in the same folder is read too.
/// @throws Error file:line:column, found and expected   @setup
[[nodiscard]] Case load_case(const std::filesystem::path& path);

/// Reads a matrix of a model from rows of numbers, or from the file that the text at `key` names.
/// @throws Error with the place of a value that is no number   @setup
[[nodiscard]] Eigen::MatrixXd read_matrix(const Config& table, const std::string& key);

}  // namespace rths::diagnosis

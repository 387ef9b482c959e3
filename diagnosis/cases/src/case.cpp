// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/case.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/cases/against.hpp>
#include <rths/core/file.hpp>
#include <rths/recording/table.hpp>

#include "case_history.hpp"
#include "case_of_run.hpp"
#include "case_record.hpp"
#include "roles.hpp"

namespace rths::diagnosis {
namespace {

std::vector<FittedParameter> read_fitted(const Config& model) {
  std::vector<FittedParameter> fitted;
  for (const auto& name : model.texts("fitted", {})) {
    for (const auto& other : fitted)
      if (other.name == name) model.fail("fitted", fmt::format("'{}' is listed twice", name));
    fitted.push_back({name, std::nullopt});
  }
  const Config bounds = model.table_or_empty("bounds");
  for (auto& parameter : fitted) {
    if (!bounds.has(parameter.name)) continue;
    const auto pair = bounds.numbers(parameter.name);
    if (pair.size() != 2 || !(pair[0] < pair[1]))
      bounds.fail(parameter.name, fmt::format("bounds are [{}], expected [low, high], low < high",
                                              fmt::join(pair, ", ")));
    parameter.bounds = {pair[0], pair[1]};
  }
  bounds.reject_unknown_keys();
  return fitted;
}

MapRange read_map(const Config& table) {
  constexpr double kLeast = 1e-12, kMost = 1e6;
  MapRange map;
  if (table.has("displacement_m"))
    map.displacement = table.number_in("displacement_m", kLeast, kMost);
  if (table.has("velocity_m_per_s"))
    map.velocity = table.number_in("velocity_m_per_s", kLeast, kMost);
  table.reject_unknown_keys();
  return map;
}

Comparison read_comparison(const Config& table) {
  constexpr double kLeast = 1e-6, kMost = 1e9;
  Comparison comparison;
  if (table.has("model_rate_Hz"))
    comparison.model_rate = table.number_in("model_rate_Hz", kLeast, kMost);
  if (table.has("cutoff_Hz")) comparison.cutoff = table.number_in("cutoff_Hz", kLeast, kMost);
  table.reject_unknown_keys();
  return comparison;
}

std::vector<std::pair<std::string, double>> read_noise(const Config& table,
                                                       const std::vector<Record>& records) {
  constexpr double kLeast = 1e-50, kMost = 1e50;  // [SI]
  std::vector<std::pair<std::string, double>> noise;
  for (const auto& role : table.keys()) {
    const auto [deviation, unit] = deviation_of(table, role);
    if (const auto trouble = trouble_with(role, unit)) table.fail(role, *trouble);
    if (!(deviation >= kLeast && deviation <= kMost))
      table.fail(role, fmt::format("standard deviation is {}, expected {} to {} in SI",
                                   table.text(role), kLeast, kMost));
    if (std::none_of(records.begin(), records.end(),
                     [&](const Record& record) { return record.find(role) != nullptr; }))
      table.fail(role, fmt::format("no record has the channel '{}'", role));
    noise.emplace_back(role, deviation);
  }
  return noise;
}

// The channels that anchor a model are found by their roles; the key keeps the model beside
// `against`.
void check_anchor(const Config& model, ModelKind kind) {
  if (!model.has("anchor")) return;
  const std::string anchor = model.text("anchor");
  if (anchor != "predicted")
    model.fail("anchor", fmt::format("anchor is '{}', expected predicted", anchor));
  if (is_prediction(kind))
    model.fail("anchor",
               fmt::format("a model of kind '{}' is the prediction, expected another kind",
                           name_of(kind)));
}

// Slices of one file have its name; later ones get a number.
void name(std::vector<Record>& records, const std::vector<Config>& tables) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto is_taken = [&](const std::string& wanted) {
      return std::any_of(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Record& other) { return other.name == wanted; });
    };
    const std::string wanted = records[i].name;
    if (!is_taken(wanted)) continue;
    if (tables[i].has("name"))
      tables[i].fail("name", fmt::format("two records are named '{}'", wanted));
    for (int count = 2; is_taken(records[i].name); ++count)
      records[i].name = fmt::format("{} ({})", wanted, count);
  }
}

// The displacement of a user's own system may be anything.
bool is_of_machine(const Config& file) {
  const auto kind = model_kind(file.table_or_empty("model").text("kind", "data"));
  return kind && is_composition(*kind);
}

std::vector<Record> read_records(const Config& file, Files& files) {
  const Config channels = file.table_or_empty("channels");
  const auto tables = file.tables("record");
  std::vector<Record> records;
  const bool is_machine = is_of_machine(file);
  for (const auto& table : tables)
    records.push_back(read_record(table, channels, files, is_machine));
  name(records, tables);
  const auto is_fit = [](const Record& record) { return record.use == Use::Fit; };
  if (std::none_of(records.begin(), records.end(), is_fit))
    file.fail("record", "no [[record]] has use = \"fit\"");
  refuse_overlap(records, tables);
  refuse_motion_at_rest(records, tables);
  return records;
}

// A law without rates alone describes rows without time.
void check_time(const Config& file, const Case& c) {
  const auto has_none = [](const Record& record) { return !record.has_time; };
  const auto count = std::count_if(c.records.begin(), c.records.end(), has_none);
  if (count == 0) return;
  if (count != std::ssize(c.records))
    file.fail("record", "some records have a time and some have none, expected all or none");
  if (file.has("compare")) file.fail("compare", "the records have no time, expected no [compare]");
  const ModelKind kind = c.model.kind;
  if (kind != ModelKind::Bearing && kind != ModelKind::Platen && kind != ModelKind::Data)
    file.fail("model",
              fmt::format("a model of kind '{}' needs records with a time, expected bearing, "
                          "platen or data",
                          name_of(kind)));
}

// The records and the model of a run; the file may replace the model.
Case case_with_run(const Config& file) {
  Case result = file.placed("run", [&] { return case_of_run(file.resolve(file.text("run"))); });
  for (const char* key : {"record", "channels"})
    if (file.has(key)) file.fail(key, "the records are those of the run, expected no such table");
  return result;
}

// Also of "." and "..".
std::string name_of_folder(const std::filesystem::path& folder) {
  const auto whole = (std::filesystem::absolute(folder) / "").lexically_normal().parent_path();
  return whole.filename().string();
}

Case case_of_file(const std::filesystem::path& path) {
  const Config file = Config::load(path).in_its_folder();
  const std::int64_t format = file.integer("format");
  if (format != kCaseFormat)
    file.fail("format", fmt::format("format is {}, this program reads {}", format, kCaseFormat));
  const bool is_of_run = file.has("run");
  Case result = is_of_run ? case_with_run(file) : Case{};
  Files files;
  if (!is_of_run) result.records = read_records(file, files);
  result.folder = path.has_parent_path() ? path.parent_path() : ".";
  result.name = name_in(file, name_of_folder(result.folder));
  if (!is_of_run || file.has("model")) result.model = read_model(file.table_or_empty("model"));
  check_time(file, result);
  // The state of a free-running model at the start of a section is its own affair: `initial`.
  if (!is_of_run && is_composition(result.model.kind))
    join_sections(result.records, file.tables("record"));
  if (!is_of_run || file.has("compare"))
    result.comparison = read_comparison(file.table_or_empty("compare"));
  result.map = read_map(file.table_or_empty("map"));
  result.noise = read_noise(file.table_or_empty("noise"), result.records);
  const std::string against = file.text("against", "");
  file.reject_unknown_keys();
  result.source.file = file;
  for (const auto& inputs : {std::vector{path}, files.paths(), file.named_files()})
    result.source.inputs.insert(result.source.inputs.end(), inputs.begin(), inputs.end());
  result.source.folder = std::filesystem::absolute(file.resolve("."));
  return against.empty() ? result : with_prediction(std::move(result), file.resolve(against));
}

}  // namespace

Model read_model(const Config& table) {
  // Their squares and ratios are finite.
  constexpr double kSmallest = 1e-100, kLargest = 1e100;
  table.limit_sizes(kSmallest, kLargest);
  const std::string kind = table.text("kind", "data");
  const auto known = model_kind(kind);
  if (!known)
    table.fail("kind",
               fmt::format("there is no model of kind '{}', expected {}", kind, model_kinds()));
  check_anchor(table, *known);
  return {*known, table, read_fitted(table)};
}

std::vector<const Record*> moving_records(const Case& c) {
  std::vector<const Record*> records;
  for (const auto& record : c.records)
    if (record.use != Use::Reference) records.push_back(&record);
  return records;
}

Case load_case(const std::filesystem::path& path) {
  std::error_code problem;
  if (std::filesystem::is_directory(path, problem)) return case_of_file(path / "case.toml");
  check_is_file(path);
  return path.extension() == ".toml" ? case_of_file(path) : case_of_run(path);
}

Eigen::MatrixXd read_matrix(const Config& table, const std::string& key) {
  if (!table.is_array(key)) {
    const auto file = recording::Table::load(table.resolve(table.text(key)));
    const auto& columns = file.columns();
    Eigen::MatrixXd matrix(columns.empty() ? 0 : columns[0].values.size(), columns.size());
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      matrix.col(j) = Eigen::Map<const Eigen::VectorXd>(
          columns[static_cast<std::size_t>(j)].values.data(), matrix.rows());
    // Of a matrix that is wider than high, the table has the rows.
    if (!columns.empty() && columns[0].slice.ends_with(",:)")) matrix.transposeInPlace();
    return matrix;
  }
  const auto rows = table.rows(key);
  Eigen::MatrixXd matrix(rows.size(), rows.empty() ? 0 : rows[0].size());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    matrix.row(i) = Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(),
                                                         matrix.cols());
  return matrix;
}

}  // namespace rths::diagnosis

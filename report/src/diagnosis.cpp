// SPDX-License-Identifier: Apache-2.0
#include <rths/report/diagnosis.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/replace_files.hpp>
#include <rths/report/report.hpp>

#include "instants.hpp"
#include "numbers.hpp"

namespace rths::report {
namespace {

namespace fs = std::filesystem;

// In the first line of each table of predictions: tells it from other files.
constexpr const char* kTableMark =
    "). before, after: predictions fitted without and with the named terms; residual:";

// report.html; in the folder of a run diagnosis.html.
fs::path page_in(const fs::path& folder) {
  std::error_code problem;
  return folder / (fs::exists(folder / kRunFile, problem) ? kDiagnosisPage : "report.html");
}

// Whether a file is a table of predictions that a diagnosis has written.
bool is_prediction(const fs::path& file) {
  std::error_code problem;
  if (file.extension() != ".csv" || !fs::is_regular_file(fs::symlink_status(file, problem)))
    return false;
  std::array<char, 1024> start{};  // longer than the name of a record and the mark
  std::ifstream{file, std::ios::binary}.read(start.data(), start.size());
  const std::string_view text{start.data(), start.size()};
  return text.starts_with("# ") && text.find(kTableMark) != std::string_view::npos;
}

// Whether a file is what a killed diagnosis has left of a table or an improved model.
bool is_draft(const fs::path& file) {
  if (file.extension() != ".part") return false;
  const fs::path finished = file.stem();
  return finished.extension() == ".csv" || finished == kImprovedCase ||
         finished == kImprovedExperiment;
}

// Whether something else has the name of a table.
bool is_foreign(const fs::path& table) {
  std::error_code problem;
  return fs::exists(fs::symlink_status(table, problem)) && !is_prediction(table);
}

constexpr const char* kFolders[] = {kImprovedFolder, kPredictionFolder};

// A path without symbolic links; the path itself if it cannot be followed.
fs::path followed(const fs::path& path) {
  std::error_code problem;
  auto end = fs::weakly_canonical(fs::absolute(path), problem);
  return problem ? fs::absolute(path).lexically_normal() : end;
}

// The entry of a folder that has the path; if it is a link, also each entry that it leads to.
std::vector<fs::path> places_of(fs::path path) {
  constexpr int kMostLinks = 40;  // as Linux follows
  std::vector<fs::path> places;
  std::error_code problem;
  for (int i = 0; i <= kMostLinks; ++i) {
    const fs::path folder = followed(fs::absolute(path).parent_path());
    places.push_back(folder / path.filename());
    const fs::path next = fs::read_symlink(places.back(), problem);
    if (problem) break;
    path = folder / next;
  }
  return places;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

std::vector<fs::path> files_in(const fs::path& folder) {
  return {folder / kVerdictFile, page_in(folder), folder / kFragmentFile, folder / kMotionFile};
}

// What a diagnosis into the folder would replace of the places of an input; empty: nothing.
fs::path replaced(const fs::path& folder, const std::vector<fs::path>& input) {
  for (const auto& file : files_in(folder))
    for (const auto& place : places_of(file))
      if (std::ranges::find(input, place) != input.end()) return file;
  for (const char* name : kFolders)
    for (const auto& place : input)
      if (is_inside(place, followed(folder / name))) return folder / name;
  return {};
}

bool has_verdict(const fs::path& folder) {
  std::error_code problem;
  if (!fs::is_regular_file(folder / kVerdictFile, problem)) return false;
  std::ifstream stream{folder / kVerdictFile};
  const Json verdict = Json::parse(stream, nullptr, false);
  return verdict.is_object() && verdict.contains("format") && verdict.contains("verdict");
}

// Whether the folder contains more than a killed diagnosis leaves, or is no folder.
bool is_used(const fs::path& folder) {
  std::error_code problem;
  if (!fs::is_directory(folder, problem))
    return fs::symlink_status(folder, problem).type() != fs::file_type::not_found;
  const fs::directory_iterator entries{folder, problem};
  return problem || std::any_of(begin(entries), end(entries),
                                [](const auto& entry) { return !is_draft(entry.path()); });
}

// CSV with a column for each channel, as rths diagnose reads it.
std::string table_of(const diagnosis::TestMotion& motion) {
  std::string text = "time";
  std::size_t rows = 0;
  for (const auto& [role, values] : motion.channels) {
    text += "," + role;
    rows = std::max(rows, values.size());
  }
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    text += fmt::format("{:.8g}", static_cast<double>(row) * motion.time_step);
    for (const auto& [role, values] : motion.channels) text += fmt::format(",{:.8g}", values[row]);
    text += '\n';
  }
  return text;
}

// The start of a text in UTF-8, which has room for an ending in a file name of 255 bytes.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMostBytes = 200;
  std::size_t end = std::min(text.size(), kMostBytes);
  const auto continues = [&] { return (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U; };
  while (end > 0 && end < text.size() && continues()) --end;
  return text.substr(0, end);
}

// "monday 03" for "rig/monday 03.csv": a file name, without the ending of another table.
std::string file_name_of(const std::string& record) {
  std::string name = record;
  for (const char* ending : {".csv", ".txt", ".mat", ".h5"})
    if (name.ends_with(ending) && name != ending) {
      name.erase(name.size() - std::string_view{ending}.size());
      break;
    }
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c == '/' || c < ' '; }, '_');
  return shortened(name.starts_with('.') ? "_" + name : name);
}

// Measurement and predictions of a record; the traces are those of its outputs.
std::string table_of(const std::vector<const diagnosis::Trace*>& traces) {
  const diagnosis::Trace& first = *traces[0];
  std::string text = fmt::format(
      "# {} ({}{}\n"
      "# measured - after; noise: standard deviation of the noise of the residual.\n# {}\n",
      shortened(first.record), first.use, kTableMark,
      first.cutoff > 0
          ? fmt::format("All columns passed a low-pass filter at {:.4g} Hz.", first.cutoff)
          : "No filter.");
  text += first.has_time ? "time [s]" : "row";
  for (const auto* trace : traces)
    for (const char* column : {"measured", "before", "after", "residual", "noise"})
      text += fmt::format(",{} {} [{}]", trace->channel, column, trace->unit);
  text += '\n';
  const int digits =
      first.time.size() < 2
          ? kDigits
          : digits_of_instants(first.time.back(), first.time[1] - first.time[0], kDigits);
  for (std::size_t i = 0; i < first.time.size(); ++i) {
    text += fmt::format("{:.{}g}", first.time[i], digits);
    for (const auto* t : traces)
      text += fmt::format(",{:.8g},{:.8g},{:.8g},{:.8g},{:.8g}", t->measured[i], t->before[i],
                          t->after[i], t->measured[i] - t->after[i], t->noise[i]);
    text += '\n';
  }
  return text;
}

// One table for each record, in a folder of their own.
std::vector<fs::path> write_predictions(const diagnosis::Verdict& verdict, const fs::path& folder,
                                        Replacements& written) {
  std::vector<std::pair<std::string, std::vector<const diagnosis::Trace*>>> records;
  for (const auto& trace : verdict.evaluation.traces) {
    if (records.empty() || records.back().first != trace.record)
      records.push_back({trace.record, {}});
    records.back().second.push_back(&trace);
  }
  std::error_code error;
  for (const auto& entry : fs::directory_iterator{folder, error}) {
    if (is_prediction(entry.path())) written.remove(entry.path());
    if (is_draft(entry.path())) fs::remove(entry.path(), error);
  }
  if (records.empty()) return {};
  fs::create_directories(folder);
  std::vector<fs::path> files;
  for (const auto& [record, traces] : records) {
    const std::string name = file_name_of(record);
    fs::path file = folder / (name + ".csv");
    const auto is_taken = [&] {
      return std::ranges::find(files, file) != files.end() || is_foreign(file);
    };
    for (int count = 2; is_taken(); ++count)
      file = folder / fmt::format("{} ({}).csv", name, count);
    written.add(file, table_of(traces));
    files.push_back(file);
  }
  return files;
}

// The start of a written TOML file. Its relative paths start at another folder.
std::string head_of(const std::string& title, const std::string& command) {
  return fmt::format("# {}, written by rths diagnose. It runs as it is, with {}.\n", title,
                     command);
}

Config placed(Config file, const fs::path& paths_from, const fs::path& folder) {
  file.put("folder", fs::proximate(paths_from, fs::absolute(folder)).string());
  return file;
}

// An experiment whose laboratory is the improved simulation, or whose simulation is improved.
Config improved_experiment(const diagnosis::CaseSource& improved, const fs::path& inside,
                           const std::optional<fs::path>& fragment) {
  Config experiment = placed(improved.experiment, improved.experiment_folder, inside);
  if (improved.has_improved_laboratory) return experiment;
  Config model = experiment.table_or_empty("model");
  auto improvement = model.texts("improvement", {});
  improvement.push_back(
      fs::proximate(fs::absolute(*fragment), improved.experiment_folder).string());
  model.put("improvement", improvement);
  experiment.set("model", model);
  return experiment;
}

// The improved case, and for a run the improved experiment.
void write_improved(const diagnosis::CaseSource& improved, const fs::path& folder,
                    DiagnosisFiles& files, Replacements& written) {
  const fs::path inside = folder / kImprovedFolder;
  if (!improved.file.keys().empty()) {
    fs::create_directories(inside);
    files.improved = inside / kImprovedCase;
    written.add(*files.improved, head_of("The case with the improved model", "rths diagnose") +
                                     placed(improved.file, improved.folder, inside).to_toml());
  }
  if (improved.experiment.keys().empty() || !(files.fragment || improved.has_improved_laboratory))
    return;
  fs::create_directories(inside);
  files.experiment = inside / kImprovedExperiment;
  written.add(*files.experiment,
              head_of(improved.has_improved_laboratory ? "The improved simulation as an experiment"
                                                       : "The experiment with the improved model",
                      "rths run") +
                  improved_experiment(improved, inside, files.fragment).to_toml());
}

}  // namespace

DiagnosisFiles write_diagnosis(const diagnosis::Verdict& verdict,
                               const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error{folder.string() + ": cannot create the folder: " + error.message()};
  DiagnosisFiles files;
  files.page = page_in(folder);
  files.numbers = folder / kVerdictFile;
  Replacements written;
  const auto fragment = folder / kFragmentFile, motion = folder / kMotionFile;
  // Proposals of an earlier diagnosis must not remain beside a verdict without any.
  for (const auto& file : {fragment, motion, folder / kImprovedFolder / kImprovedCase,
                           folder / kImprovedFolder / kImprovedExperiment})
    written.remove(file);
  // First, so that a commit that is cut off leaves a folder with a verdict.
  written.add(files.numbers, verdict_json(verdict));
  written.add(files.page, verdict_page(verdict));
  if (!verdict.improvement.fragment.empty()) {
    written.add(fragment, verdict.improvement.fragment);
    files.fragment = fragment;
  }
  write_improved(verdict.improvement.source, folder, files, written);
  files.predictions = write_predictions(verdict, folder / kPredictionFolder, written);
  if (!verdict.next.motion.channels.empty()) {
    written.add(motion, table_of(verdict.next.motion));
    files.motion = motion;
  }
  written.commit();
  for (const char* emptied : {kImprovedFolder, kPredictionFolder})
    rmdir((folder / emptied).c_str());  // fails if it is not empty
  return files;
}

void refuse_inputs_in(const fs::path& folder, const std::vector<fs::path>& inputs) {
  for (const auto& input : inputs) {
    const fs::path result = replaced(folder, places_of(input));
    if (result.empty()) continue;
    throw Error{
        fmt::format("{}: is an input of the case, and the results would replace {}, "
                    "expected another folder for them (--out)",
                    input.string(), result.string())};
  }
}

void refuse_foreign_files_in(const fs::path& folder) {
  if (has_verdict(folder)) return;
  std::vector<fs::path> found = files_in(folder);
  for (const char* name : kFolders) found.push_back(folder / name);
  std::string names;
  for (const auto& path : found)
    if (is_used(path)) names += (names.empty() ? "" : ", ") + path.filename().string();
  if (names.empty()) return;
  throw Error{
      fmt::format("{}: holds {}, which the results would replace, but no verdict.json of an "
                  "earlier diagnosis, expected another folder for them (--out)",
                  folder.string(), names)};
}

}  // namespace rths::report

// SPDX-License-Identifier: Apache-2.0
#include "result_folder.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>

#include "numbers.hpp"

namespace rths::report {
namespace {

namespace fs = std::filesystem;

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
      if (std::find(input.begin(), input.end(), place) != input.end()) return file;
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

}  // namespace

fs::path page_in(const fs::path& folder) {
  std::error_code problem;
  return folder / (fs::exists(folder / kRunFile, problem) ? kDiagnosisPage : "report.html");
}

bool is_prediction(const fs::path& file) {
  std::error_code problem;
  if (file.extension() != ".csv" || !fs::is_regular_file(fs::symlink_status(file, problem)))
    return false;
  std::array<char, 1024> start{};  // longer than the name of a record and the mark
  std::ifstream{file, std::ios::binary}.read(start.data(), start.size());
  const std::string_view text{start.data(), start.size()};
  return text.starts_with("# ") && text.find(kTableMark) != std::string_view::npos;
}

bool is_draft(const fs::path& file) {
  if (file.extension() != ".part") return false;
  const fs::path finished = file.stem();
  return finished.extension() == ".csv" || finished == kImprovedCase ||
         finished == kImprovedExperiment;
}

bool is_foreign(const fs::path& table) {
  std::error_code problem;
  return fs::exists(fs::symlink_status(table, problem)) && !is_prediction(table);
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

// SPDX-License-Identifier: Apache-2.0
#include "runs.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

#include <nlohmann/json.hpp>

namespace rths::monitor {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kDeepest = 4;  // of a run below the folder
constexpr std::size_t kMostRuns = 500;
constexpr std::size_t kMostFolders = 20000;

struct Found {
  fs::path folder;
  fs::file_time_type time;
};

// Folders with a recording. Links, such as "latest", are not followed.
std::vector<Found> recordings_in(const fs::path& folder) {
  std::vector<Found> found;
  std::error_code error;
  fs::recursive_directory_iterator at{folder, fs::directory_options::skip_permission_denied, error};
  for (std::size_t i = 0; !error && at != fs::end(at) && i < kMostFolders; ++i) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    std::error_code ignored;
    if (at->path().filename() == "run.h5" && at->is_regular_file(ignored))
      found.push_back({at->path().parent_path(), at->last_write_time(ignored)});
    at.increment(error);
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.time > b.time; });
  if (found.size() > kMostRuns) found.resize(kMostRuns);
  return found;
}

Json numbers_of(const fs::path& folder) {
  std::ifstream stream{folder / "report.json"};
  if (!stream) return nullptr;
  return Json::parse(stream, nullptr, false);
}

Json figures_of(const Json& report) {
  Json figures = Json::object();
  const Json axes = report.value("axes", Json::object());
  for (const auto& [axis, numbers] : axes.items())
    for (const char* key : {"nrms_percent", "delay_compensated_ms", "peak_displacement_mm",
                            "peak_shear_kN", "numerical_difference_percent"})
      if (numbers.contains(key) && numbers[key].is_number()) figures[key][axis] = numbers[key];
  return figures;
}

Json json_of(const Found& run, const fs::path& root) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::file_clock::to_sys(run.time).time_since_epoch());
  Json json = {{"folder", run.folder.lexically_relative(root).generic_string()},
               {"time_s", seconds.count()}};
  const auto has = [&](const char* file) {
    std::error_code ignored;
    return fs::exists(run.folder / file, ignored);
  };
  if (has("report.html")) json["report"] = "report.html";
  if (has("diagnosis.html")) json["diagnosis"] = "diagnosis.html";
  const Json report = numbers_of(run.folder);
  if (!report.is_object()) {
    json["note"] = report.is_null() ? "no report: the run has not ended, or ended without one"
                                    : "report.json cannot be read";
    return json;
  }
  try {
    json["name"] = report.value("name", "");
    json["conclusive"] = report.value("conclusive", false);
    json["clock"] = report.value("clock", "");
    json["duration_s"] = report.value("duration_s", 0.0);
    if (const auto& ending = report.value("ending", Json{}); ending.is_string())
      json["note"] = ending;
    json["figures"] = figures_of(report);
    if (const auto& found = report.value("diagnosis", Json{}); found.is_object())
      json["verdict"] = found.value("sentence", "");
  } catch (const Json::exception&) {
    json["note"] = "report.json is of another version";
  }
  return json;
}

}  // namespace

std::string runs_in(const fs::path& folder) {
  Json list = Json::array();
  for (const auto& run : recordings_in(folder)) list.push_back(json_of(run, folder));
  return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<fs::path> below(const fs::path& folder, const std::string& relative) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return std::nullopt;
  const fs::path file = fs::canonical(root / fs::path{relative}.relative_path(), error);
  if (error) return std::nullopt;
  const auto [end, ignored] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  return end == root.end() ? std::optional{file} : std::nullopt;
}

}  // namespace rths::monitor

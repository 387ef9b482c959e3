// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include <rths/session/diagnose.hpp>
#include <rths/session/run.hpp>

namespace rths::session {
namespace {

using Json = nlohmann::ordered_json;

Json path_or_null(const std::filesystem::path& path) {
  return path.empty() ? Json() : Json(path.string());
}

std::string text_of(const Json& document) {
  // File names need not be UTF-8.
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string json_of(const RunResult& result) {
  Json broken = Json::array();
  for (const auto& condition : result.broken)
    broken.push_back({{"condition", condition.condition},
                      {"time_s", condition.time},
                      {"signal", condition.signal},
                      {"found", condition.found},
                      {"expected", condition.expected}});
  const auto page = result.diagnosis ? result.diagnosis->page : "";
  return text_of({{"completed", result.outcome.completed},
                  {"conclusive", result.is_conclusive()},
                  {"ending", result.ending()},
                  {"folder", path_or_null(result.folder)},
                  {"recording", path_or_null(result.recording)},
                  {"no_recording", result.no_recording},
                  {"rows_missing", result.outcome.rows_missing},
                  {"broken", broken},
                  {"not_made", result.not_made},
                  {"verdict", result.verdict},
                  {"diagnosis", path_or_null(page)},
                  {"no_diagnosis", result.no_diagnosis},
                  {"report", path_or_null(result.report ? result.report->numbers : "")}});
}

std::string json_of(const DiagnosisResult& result) {
  return text_of({{"verdict", diagnosis::answers_of(result.verdict).headline},
                  {"page", result.files.page.string()},
                  {"numbers", result.files.numbers.string()}});
}

}  // namespace rths::session

// SPDX-License-Identifier: Apache-2.0
#include "short_run.hpp"

#include <rths/recording/recording.hpp>

#include "support/json.hpp"

namespace rths::launch {
namespace {

constexpr double kDeadline = 300;  // [s]

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

ShortRun::ShortRun(const std::filesystem::path& experiment, const std::vector<Set>& sets)
    : experiment_{experiment.string()} {
  for (const auto& [key, value] : sets)
    experiment_.insert(experiment_.end(), {"--set", key + "=" + value});
  finished_ = test::run_rths(
      joined(joined({"run"}, experiment_),
             {"--clock", "virtual", "--no-diagnosis", "--out", (folder_.path() / "run").string(),
              "--ring", folder_.path().filename().string()}),
      kDeadline);
}

std::filesystem::path ShortRun::at(const std::string& file) const {
  return folder_.path() / "run" / file;
}

bool ShortRun::has_run() const { return std::filesystem::exists(at("run.h5")); }

bool ShortRun::is_accepted_by_check() const {
  const auto check = test::run_rths(joined({"check"}, experiment_), kDeadline);
  return check.exit_code == 0 && check.err.empty();
}

bool ShortRun::has_same_results(const ShortRun& other) const {
  for (const char* file : {"run.h5", "held_out.h5", "uncompensated.h5", "numerical.h5"})
    if (!has_same_signals(other, file)) return false;
  return numbers() == other.numbers();
}

bool ShortRun::has_same_signals(const ShortRun& other, const std::string& file) const {
  if (!std::filesystem::exists(at(file))) return !std::filesystem::exists(other.at(file));
  if (!std::filesystem::exists(other.at(file))) return false;
  return recording::hold_same_signals(recording::Reader{at(file)},
                                      recording::Reader{other.at(file)});
}

// The command repeats every change, and the rest is about the program.
nlohmann::json ShortRun::numbers() const {
  if (!std::filesystem::exists(at("report.json"))) return {};
  nlohmann::json json = test::json_of(at("report.json"));
  json.erase("command");
  json.erase("meta");
  return json;
}

}  // namespace rths::launch

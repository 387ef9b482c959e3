// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/plugin/conformance.hpp>

#include "commands.hpp"

namespace rths::app {

int check_plugin(const std::string& file, const std::string& config) {
  plugin::ConformanceSettings settings;
  if (!config.empty()) settings.config = Config::load(config).to_toml();
  const auto findings = plugin::check_plugin(file, settings);
  using Outcome = plugin::Finding::Outcome;
  const auto count = [&](Outcome outcome) {
    return std::count_if(findings.begin(), findings.end(),
                         [&](const auto& finding) { return finding.outcome == outcome; });
  };
  for (const auto& [rule, outcome, text] : findings) {
    const char* word = outcome == Outcome::Pass ? "PASS" : "FAIL";
    if (outcome == Outcome::NotTried) word = "----";
    fmt::print("{}  {:<12} {}\n", word, rule, outcome == Outcome::NotTried ? "not tried" : text);
  }
  fmt::print("{}: plugin, {} of {} rules passed, {} failed, {} not tried\n", file,
             count(Outcome::Pass), findings.size(), count(Outcome::Fail), count(Outcome::NotTried));
  return count(Outcome::Fail) == 0 ? kOk : kConditionNotMet;
}

}  // namespace rths::app

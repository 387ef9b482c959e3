// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/fmu_check.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/plugin/conformance.hpp>

#include <rths/fmi/fmu_files.hpp>
#include "bindings.hpp"
#include "fmu_config.hpp"

namespace rths::fmi {
namespace {

using adapters::Finding;

std::string summary_of(const ModelDescription& description) {
  const auto count = [&](const char* causality) {
    return std::count_if(description.variables.begin(), description.variables.end(),
                         [&](const auto& variable) { return variable.causality == causality; });
  };
  return fmt::format("'{}', FMI {}, {} inputs, {} outputs, {} parameters", description.name,
                     description.version_text, count("input"), count("output"), count("parameter"));
}

}  // namespace

bool is_fmu(const std::filesystem::path& path) {
  return std::filesystem::exists(path) &&
         (path.extension() == ".fmu" || std::filesystem::exists(path / "modelDescription.xml"));
}

std::vector<Finding> check_fmu(const std::filesystem::path& file, const Config& config) {
  std::vector<Finding> findings{{"description", Finding::Outcome::Pass, ""}};
  plugin::ConformanceSettings settings;
  try {
    const ModelDescription description = read_description(file);
    const FmuFiles files{file};
    const Config table = with_names(description, config, [](const auto&) { return true; });
    settings.period =
        description.preferred_step.value_or(description.fixed_step.value_or(settings.period));
    settings.config = config_of(description, table, {files.folder(), "check", settings.period});
    static_cast<void>(read_bindings(description, table, true));
    static_cast<void>(library_in(files.folder(), description));
    settings.built_in = &fmu_adapter();
    findings.back().text = summary_of(description);
    for (auto& finding : plugin::check_plugin(file, settings))
      if (finding.rule != "exports" && finding.rule != "abi")
        findings.push_back(std::move(finding));
  } catch (const Error& error) {
    findings.back().outcome = Finding::Outcome::Fail;
    findings.back().text = error.what();
  }
  return findings;
}

}  // namespace rths::fmi

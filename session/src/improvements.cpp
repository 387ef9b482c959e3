// SPDX-License-Identifier: Apache-2.0
#include <rths/session/improvements.hpp>

#include <rths/core/config.hpp>
#include <rths/core/toml_list.hpp>

namespace rths::session {

std::vector<std::filesystem::path> improvements_of(const std::filesystem::path& experiment,
                                                   const experiment::Overrides& changes) {
  const Config model = experiment::changed_experiment(experiment, changes).table_or_empty("model");
  std::vector<std::filesystem::path> files;
  for (const auto& file : model.texts("improvement", {})) files.push_back(model.resolve(file));
  return files;
}

experiment::Overrides improved_by(const std::vector<std::filesystem::path>& files,
                                  const std::filesystem::path& experiment,
                                  experiment::Overrides changes) {
  if (files.empty()) return changes;
  auto all = improvements_of(experiment, changes);
  all.insert(all.end(), files.begin(), files.end());
  std::vector<std::string> paths;
  for (const auto& file : all) paths.push_back(std::filesystem::weakly_canonical(file).string());
  changes.emplace_back("model.improvement", toml_list(paths));
  return changes;
}

}  // namespace rths::session

// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/block_settings.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::adapters {

namespace {

void replace_keys(std::vector<Config>& blocks, const Config& changes) {
  std::vector<std::string> names;
  for (auto& block : blocks) {
    names.push_back(block.text("name", ""));
    if (changes.has(names.back())) block = block.overlaid(changes.table(names.back()));
  }
  for (const auto& key : changes.keys())
    if (std::find(names.begin(), names.end(), key) == names.end())
      changes.fail(key,
                   fmt::format("the diagram has no block '{}'{}", key, did_you_mean(key, names)));
}

}  // namespace

DiagramChoice read_diagram_choice(const Config& table) {
  DiagramChoice choice{find_file(table, "diagram", "diagrams"), {}, {}};
  if (table.has("constants")) choice.constants = table.resolve(table.text("constants"));
  choice.blocks = table.table_or_empty("blocks");
  return choice;
}

std::vector<Config> blocks_of(const Config& diagram, const std::filesystem::path& constants,
                              const Config& experiment) {
  auto blocks = diagram.tables("block");
  if (!constants.empty()) replace_keys(blocks, Config::load(constants));
  replace_keys(blocks, experiment);
  return blocks;
}

}  // namespace rths::adapters

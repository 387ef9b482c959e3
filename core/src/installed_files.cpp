// SPDX-License-Identifier: Apache-2.0
#include <rths/core/installed_files.hpp>

#include <set>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths {
namespace {

constexpr const char* kRecordsFolder = "examples/records";

std::string ending_in(const std::string& folder) {
  if (folder == "maps") return ".ringmap.toml";
  return folder == kRecordsFolder ? ".csv" : ".toml";
}

std::filesystem::path installed(const std::string& name, const std::string& folder) {
  return shared_files() / folder / (name + ending_in(folder));
}

bool is_bare_name(const std::string& name) {
  return name.find('/') == std::string::npos && name.find('.') == std::string::npos;
}

std::filesystem::path find_named(const std::string& name_or_path, const char* kind,
                                 const std::string& folder) {
  if (!is_bare_name(name_or_path)) return name_or_path;
  auto file = installed(name_or_path, folder);
  if (std::filesystem::exists(file)) return file;
  if (std::filesystem::exists(name_or_path)) return name_or_path;
  throw Error{fmt::format("there is no {} '{}', expected a file or one of: {}", kind, name_or_path,
                          fmt::join(built_in_names(folder), ", "))};
}

}  // namespace

std::filesystem::path shared_files() {
  const auto command = std::filesystem::read_symlink("/proc/self/exe");
  return command.parent_path().parent_path() / "share" / "rths";
}

std::vector<std::string> built_in_names(const std::string& folder) {
  std::set<std::string> names;
  std::error_code missing;
  for (const auto& file : std::filesystem::directory_iterator{shared_files() / folder, missing}) {
    const std::string name = file.path().filename().string();
    if (name.ends_with(ending_in(folder))) names.insert(name.substr(0, name.find('.')));
  }
  return {names.begin(), names.end()};
}

std::filesystem::path find_map(const std::string& name_or_path) {
  return find_named(name_or_path, "map", "maps");
}

std::filesystem::path find_bearing(const std::string& name_or_path) {
  return find_named(name_or_path, "bearing", "bearings");
}

std::filesystem::path find_file(const Config& table, const std::string& key,
                                const std::string& folder, const std::string& otherwise) {
  const std::string name = otherwise.empty() ? table.text(key) : table.text(key, otherwise);
  auto file = is_bare_name(name) ? installed(name, folder) : table.resolve(name);
  if (!std::filesystem::exists(file)) file = table.resolve(name);
  if (!std::filesystem::exists(file))
    table.fail(key, fmt::format("{} is '{}', expected a file or one of: {}", key, name,
                                fmt::join(built_in_names(folder), ", ")));
  return file;
}

}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
#include <rths/plugin/python_file.hpp>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::plugin {
namespace {

constexpr const char* kHost = "librths_python_adapter.so";

// Beside the libraries of this installation.
std::filesystem::path host_of_python(const std::filesystem::path& file) {
  const auto prefix = shared_files().parent_path().parent_path();
  for (const char* folder : {"lib", RTHS_LIBDIR})
    if (auto host = prefix / folder / "rths" / kHost; std::filesystem::exists(host)) return host;
  throw Error{fmt::format("{}: this installation has no {}, expected one built with RTHS_PYTHON=ON",
                          file.string(), kHost)};
}

}  // namespace

PluginFile plugin_file(const std::filesystem::path& file, const std::string& config) {
  if (file.extension() != ".py") return {file, config, {}, false};
  Config table;
  table.put("file", std::filesystem::absolute(file).string());
  table.set("config", Config::parse(config, "config"));
  return {host_of_python(file), table.to_toml(),
          fmt::format("adapter in Python ({})", file.filename().string()), true};
}

}  // namespace rths::plugin

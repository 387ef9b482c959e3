// SPDX-License-Identifier: Apache-2.0
#include <rths/plugin/library.hpp>

#include <dlfcn.h>

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

constexpr const char* kEntry = "rths_adapter_entry";
constexpr std::uint32_t kSmallestSize = offsetof(rths_adapter, stop);  // of minor 0

std::string version_text(std::uint32_t abi) {
  return fmt::format("{}.{}", abi >> 16, abi & 0xFFFF);
}

// Describes the first fault; empty if there is none.
std::string fault_of(const rths_adapter& adapter) {
  if (adapter.abi >> 16 != RTHS_ADAPTER_ABI_MAJOR)
    return fmt::format(
        "has adapter ABI {}, expected {}.x: build it against this version's "
        "rths_adapter.h",
        version_text(adapter.abi), RTHS_ADAPTER_ABI_MAJOR);
  if (adapter.struct_size < kSmallestSize)
    return fmt::format("has struct_size {}, expected sizeof(rths_adapter), at least {}",
                       adapter.struct_size, kSmallestSize);
  const auto is_empty = [](const char* text) { return text == nullptr || *text == '\0'; };
  if (is_empty(adapter.name) || is_empty(adapter.version)) return "has no name or no version";
  const bool is_complete = adapter.create != nullptr && adapter.signals != nullptr &&
                           adapter.activate != nullptr && adapter.step != nullptr &&
                           adapter.deactivate != nullptr && adapter.destroy != nullptr;
  if (!is_complete)
    return "lacks a function, expected create, signals, activate, step, deactivate and destroy";
  return "";
}

}  // namespace

Library::Library(std::filesystem::path file) : Library{std::move(file), nullptr} {}

Library::Library(std::filesystem::path file, const rths_adapter* built_in)
    : file_{std::move(file)}, adapter_{built_in}, is_built_in_{built_in != nullptr} {
  if (!is_built_in_) load();
}

// All symbols are bound now, so that no step has to look one up.
void Library::load() {
  void* handle = dlopen(file_.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) throw Error{fmt::format("cannot load the plugin: {}", dlerror())};
  const auto entry = reinterpret_cast<const rths_adapter* (*)()>(dlsym(handle, kEntry));
  if (entry == nullptr)
    throw Error{fmt::format("{}: exports no {}, expected an adapter", file_.string(), kEntry)};
  adapter_ = entry();
  if (adapter_ == nullptr)
    throw Error{fmt::format("{}: {} returned NULL, expected an adapter", file_.string(), kEntry)};
  if (const auto fault = fault_of(*adapter_); !fault.empty())
    throw Error{fmt::format("{}: {}", file_.string(), fault)};
}

std::string Library::title() const {
  if (is_built_in_) return fmt::format("{} '{}'", adapter_->name, file_.filename().string());
  return fmt::format("plugin '{}' ({})", adapter_->name, file_.filename().string());
}

PluginFile plugin_file(const std::filesystem::path& file, const std::string& config) {
  if (file.extension() != ".py") return {file, config, {}, false};
  Config table;
  table.put("file", std::filesystem::absolute(file).string());
  table.set("config", Config::parse(config, "config"));
  return {host_of_python(file), table.to_toml(),
          fmt::format("adapter in Python ({})", file.filename().string()), true};
}

}  // namespace rths::plugin

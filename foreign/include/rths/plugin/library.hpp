// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <rths_adapter.h>

namespace rths::plugin {

inline constexpr std::uint32_t kMostSignals = 10'000;  ///< of an adapter

/// Whether an adapter reads a signal in a step; it writes the others.
template <class Signal>
[[nodiscard]] bool is_read(const Signal& signal) {
  return signal.direction == RTHS_INPUT || signal.direction == RTHS_PARAMETER;
}

/// What to load for the plugin of a user: his library itself, or for a file in Python the host of
/// such files.
struct PluginFile {
  std::filesystem::path library;
  std::string config;  ///< TOML text, for the library
  std::string title;   ///< for messages; empty: that of the library
  bool is_python = false;
};

/// @param file    a shared library, or a file that ends with .py
/// @param config  of the user, TOML text
/// @throws Error if this installation has no Python   @setup
[[nodiscard]] PluginFile plugin_file(const std::filesystem::path& file, const std::string& config);

/// A shared library that exports an adapter. It stays loaded until the process ends, because its
/// threads and exit handlers may still run. Or an adapter of this program that reads a file.
class Library {
 public:
  /// Loads a library and checks its version and its functions.
  /// @throws Error if it cannot be loaded or used   @setup
  explicit Library(std::filesystem::path file);
  /// @param built_in  an adapter of this program; `file` is what it reads. Null: loads the library
  Library(std::filesystem::path file, const rths_adapter* built_in);

  [[nodiscard]] const rths_adapter& adapter() const { return *adapter_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// "plugin 'name' (file)", or "name 'file'" of a built-in adapter; for messages.
  [[nodiscard]] std::string title() const;
  /// Members of a later minor; null if the adapter has none.
  [[nodiscard]] void (*stop() const)(void*) {
    return has(offsetof(rths_adapter, stop)) ? adapter_->stop : nullptr;
  }
  [[nodiscard]] const char* (*message() const)(void*) {
    return has(offsetof(rths_adapter, message)) ? adapter_->message : nullptr;
  }

 private:
  [[nodiscard]] bool has(std::size_t offset) const {
    return adapter_->struct_size >= offset + sizeof(void (*)());
  }
  void load();

  std::filesystem::path file_;
  const rths_adapter* adapter_ = nullptr;
  bool is_built_in_ = false;
};

}  // namespace rths::plugin

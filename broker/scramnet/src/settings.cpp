// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"

#include <charconv>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

namespace rths::scramnet {
namespace {

constexpr std::uint64_t kSmallestMemory = 4096;
constexpr std::uint64_t kLargestMemory = 128U << 20U;
constexpr std::uint64_t kPage = 4096;

std::string& config_file() {
  static std::string file;
  return file;
}

std::optional<std::string> variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>{value};
}

std::string size_error(std::uint64_t bytes) {
  if (bytes >= kSmallestMemory && bytes <= kLargestMemory && bytes % kPage == 0) return "";
  return fmt::format("is {}, expected {} to {} in whole pages of {}", bytes, kSmallestMemory,
                     kLargestMemory, kPage);
}

void read_size(const std::string& name, std::uint64_t& bytes) {
  const auto text = variable(name);
  if (!text) return;
  std::uint64_t value = 0;
  const auto [end, problem] = std::from_chars(text->data(), text->data() + text->size(), value);
  const bool number = problem == std::errc{} && end == text->data() + text->size();
  if (!number) throw Error{fmt::format("{} is '{}', expected a number of bytes", name, *text)};
  if (const auto error = size_error(value); !error.empty()) throw Error{name + " " + error};
  bytes = value;
}

void read_flag(const std::string& name, bool& flag) {
  const auto text = variable(name);
  if (!text) return;
  if (*text != "0" && *text != "1")
    throw Error{fmt::format("{} is '{}', expected 0 or 1", name, *text)};
  flag = *text == "1";
}

void read_environment(Settings& settings) {
  const std::string& prefix = settings.variables;
  settings.ring = variable(prefix + "RING").value_or(settings.ring);
  settings.map = variable(prefix + "MAP").value_or(settings.map);
  settings.node = variable(prefix + "NODE").value_or(settings.node);
  read_size(prefix + "BYTES", settings.ring_bytes);
  read_size(prefix + "CARD_BYTES", settings.card_bytes);
  read_flag(prefix + "SHARE", settings.share);
  read_flag(prefix + "TRAPS", settings.traps);
}

void read_size(const Config& table, const std::string& key, std::uint64_t& bytes) {
  if (!table.has(key)) return;
  bytes = static_cast<std::uint64_t>(table.integer_in(key, 0, std::int64_t{kLargestMemory}));
  if (const auto error = size_error(bytes); !error.empty()) table.fail(key, key + " " + error);
}

void read_table(const Config& table, Settings& settings) {
  settings.ring = table.text("ring", settings.ring);
  if (table.has("map")) settings.map = table.resolve(table.text("map")).string();
  settings.node = table.text("node", settings.node);
  read_size(table, "ring_bytes", settings.ring_bytes);
  read_size(table, "card_bytes", settings.card_bytes);
  settings.bypass_switch = table.flag("bypass_switch", settings.bypass_switch);
  settings.share = table.flag("share", settings.share);
  settings.traps = table.flag("traps", settings.traps);
  table.reject_unknown_keys();
}

void read_file(const std::string& key, Settings& settings) {
  std::string file = config_file();
  if (file.empty()) file = variable("RTHS_SCRAMNET_CONFIG").value_or("");
  if (file.empty()) return;
  const auto config = Config::load(file);
  static_cast<void>(config.has("scramnet"));
  static_cast<void>(config.has("scgt"));
  read_table(config.table_or_empty(key), settings);
  static_cast<void>(config.table_or_empty(key == "scgt" ? "scramnet" : "scgt"));
  config.reject_unknown_keys();
}

void read_all(const std::string& table, Settings& settings) {
  const std::string usual = settings.ring;
  read_file(table, settings);
  read_environment(settings);
  settings.ring_is_chosen = settings.ring != usual;
}

}  // namespace

Settings plus_settings() {
  Settings settings;
  read_all("scramnet", settings);
  return settings;
}

Settings gt_settings(std::uint32_t unit) {
  Settings settings;
  settings.ring = "scgt";
  settings.ring_bytes = kLargestMemory;
  settings.variables = kGtVariables;
  read_all("scgt", settings);
  if (unit != 0) settings.ring += fmt::format("{}", unit);
  return settings;
}

void set_config_file(const char* file) { config_file() = file == nullptr ? "" : file; }

}  // namespace rths::scramnet

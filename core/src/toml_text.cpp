// SPDX-License-Identifier: Apache-2.0
#include "toml_text.hpp"

#include <sstream>
#include <type_traits>
#include <variant>

#include <fmt/format.h>
#include <toml++/toml.h>

#include <rths/core/error.hpp>

#include "toml_depth.hpp"

namespace rths {
namespace {

std::string place(const std::string& name, const toml::source_region& source) {
  return fmt::format("{}:{}:{}", name, source.begin.line, source.begin.column);
}

ConfigValue convert(const toml::node& node, const std::string& name);

ConfigValue::Table convert_table(const toml::table& table, const std::string& name) {
  ConfigValue::Table result;
  for (const auto& [key, value] : table) result.emplace(key.str(), convert(value, name));
  return result;
}

ConfigValue convert(const toml::node& node, const std::string& name) {
  const std::string where = place(name, node.source());
  if (const auto* table = node.as_table()) return {convert_table(*table, name), where};
  if (const auto* array = node.as_array()) {
    ConfigValue::Array items;
    for (const auto& item : *array) items.push_back(convert(item, name));
    return {std::move(items), where};
  }
  if (const auto truth = node.value_exact<bool>()) return {*truth, where};
  if (const auto whole = node.value_exact<std::int64_t>()) return {*whole, where};
  if (const auto real = node.value_exact<double>()) return {*real, where};
  if (const auto text = node.value_exact<std::string>()) return {*text, where};
  throw Error{where + ": dates and times are not supported"};
}

toml::table written_table(const ConfigValue::Table& table);

toml::array written_array(const ConfigValue::Array& items) {
  toml::array result;
  for (const auto& item : items)
    std::visit(
        [&](const auto& value) {
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<T, ConfigValue::Array>)
            result.push_back(written_array(value));
          else if constexpr (std::is_same_v<T, ConfigValue::Table>)
            result.push_back(written_table(value));
          else
            result.push_back(value);
        },
        item.value);
  return result;
}

toml::table written_table(const ConfigValue::Table& table) {
  toml::table result;
  for (const auto& [name, entry] : table)
    std::visit(
        [&, &key = name](const auto& value) {
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<T, ConfigValue::Array>)
            result.insert(key, written_array(value));
          else if constexpr (std::is_same_v<T, ConfigValue::Table>)
            result.insert(key, written_table(value));
          else
            result.insert(key, value);
        },
        entry.value);
  return result;
}

}  // namespace

std::string write_toml(const ConfigValue::Table& table) {
  std::ostringstream stream;
  stream << toml::toml_formatter{
      written_table(table), toml::toml_formatter::default_flags & ~toml::format_flags::indentation};
  return stream.str() + "\n";
}

ConfigValue::Table parse_toml(std::string_view text, const std::string& name) {
  if (const std::size_t line = line_too_deep(text); line != 0)
    throw Error{
        fmt::format("{}:{}: a key or value is nested too deeply, expected at most {} levels", name,
                    line, kDeepest)};
  try {
    return convert_table(toml::parse(text, name), name);
  } catch (const toml::parse_error& error) {
    throw Error{fmt::format("{}: {}", place(name, error.source()), error.description())};
  }
}

}  // namespace rths

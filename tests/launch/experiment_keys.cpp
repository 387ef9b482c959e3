// SPDX-License-Identifier: Apache-2.0
#include "experiment_keys.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::launch {
namespace {

std::string list_of(const std::vector<double>& values, double factor, double increment) {
  std::string text;
  for (const double value : values)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", value == 0 ? increment : factor * value);
  return "[" + text + "]";
}

std::string list_of_rows(const std::vector<std::vector<double>>& rows, double factor) {
  std::string text;
  for (const auto& row : rows) text += (text.empty() ? "" : ", ") + list_of(row, factor, 0.01);
  return "[" + text + "]";
}

// Other values of a key, as TOML.
std::vector<std::string> values_for(const Config& table, const std::string& key) {
  if (key == "duration_s") return {"2.5"};  // of a short run
  if (key == "rest_s") return {"0.3"};
  try {
    return {table.flag(key, false) ? "false" : "true"};
  } catch (const Error&) {
  }
  try {
    const auto whole = table.integer(key);
    return {fmt::format("{}", whole + 1), fmt::format("{}", whole - 1)};
  } catch (const Error&) {
  }
  try {
    const double number = table.number(key);
    if (number == 0) return {"0.01", "1.0"};
    return {fmt::format("{}", 1.1 * number), fmt::format("{}", 0.9 * number)};
  } catch (const Error&) {
  }
  try {
    const auto numbers = table.numbers(key);
    if (numbers.empty()) return {"[0.01]", "[0.01, 0.01]"};
    return {list_of(numbers, 1.1, 0.01), list_of(numbers, 0.9, 0.01)};
  } catch (const Error&) {
  }
  try {
    const auto rows = table.rows(key);
    return {list_of_rows(rows, 1.1), list_of_rows(rows, 0.9)};
  } catch (const Error&) {
  }
  try {
    return {fmt::format("\"{}_\"", table.text(key))};
  } catch (const Error&) {
  }
  return {table.texts(key) == std::vector<std::string>{"long"} ? "[\"lat\"]" : "[\"long\"]"};
}

bool is_list_of_tables(const Config& table, const std::string& key) {
  if (!table.is_array(key)) return false;
  try {
    return !table.tables(key).empty();
  } catch (const Error&) {
    return false;
  }
}

// The whole list with one value changed: --set replaces a list as a whole.
void add_keys_of_list(const std::vector<Config>& tables, const std::string& list,
                      std::vector<Key>& keys) {
  for (std::size_t i = 0; i < tables.size(); ++i)
    for (const auto& name : tables[i].keys()) {
      Key key{fmt::format("{}[{}].{}", list, i, name), {}};
      for (const auto& value : values_for(tables[i], name)) {
        auto changed = tables;
        changed[i].set(name, value);
        key.changes.push_back({list, list_of_tables(changed)});
      }
      keys.push_back(std::move(key));
    }
}

void add_keys(const Config& table, const std::string& prefix, std::vector<Key>& keys) {
  for (const auto& name : table.keys()) {
    if (table.is_table(name)) {
      add_keys(table.table(name), prefix + name + ".", keys);
    } else if (is_list_of_tables(table, name)) {
      add_keys_of_list(table.tables(name), prefix + name, keys);
    } else {
      Key key{prefix + name, {}};
      for (const auto& value : values_for(table, name)) key.changes.push_back({key.name, value});
      keys.push_back(std::move(key));
    }
  }
}

}  // namespace

std::vector<Key> keys_of(const Config& file) {
  std::vector<Key> keys;
  add_keys(file, "", keys);
  return keys;
}

std::string list_of_tables(const std::vector<Config>& tables) {
  std::string list;
  for (const auto& table : tables) {
    std::istringstream lines{table.to_toml()};
    std::string values, line;
    while (std::getline(lines, line)) {
      if (line.empty()) continue;
      if (line[0] == '[') throw Error{"a table in a list of tables: " + line};
      values += (values.empty() ? "" : ", ") + line;
    }
    list += (list.empty() ? "{" : ", {") + values + "}";
  }
  return "[" + list + "]";
}

}  // namespace rths::launch

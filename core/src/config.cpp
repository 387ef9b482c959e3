// SPDX-License-Identifier: Apache-2.0
#include <rths/core/config.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include <rths/core/file.hpp>

#include "toml_text.hpp"

namespace rths {
namespace {

std::string kind_of(const ConfigValue& value) {
  constexpr const char* kKinds[] = {"a boolean", "an integer", "a number",
                                    "a string",  "an array",   "a table"};
  return kKinds[value.value.index()];
}

[[noreturn]] void fail_kind(const std::string& key, const ConfigValue& found,
                            const std::string& expected) {
  throw Error{fmt::format("{}: {} is {}, expected {}", found.where, key, kind_of(found), expected)};
}

double as_number(const std::string& key, const ConfigValue& value) {
  if (const auto* real = std::get_if<double>(&value.value)) {
    if (std::isfinite(*real)) return *real;
    throw Error{fmt::format("{}: {} is {}, expected a finite number", value.where, key, *real)};
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value.value))
    return static_cast<double>(*whole);
  fail_kind(key, value, "a number");
}

template <class T>
const T& as(const std::string& key, const ConfigValue& value, const std::string& expected) {
  if (const T* held = std::get_if<T>(&value.value)) return *held;
  fail_kind(key, value, expected);
}

template <class T>
void check_range(const Config& config, const std::string& key, T value, T low, T high) {
  if (!(value >= low && value <= high))
    config.fail(key, fmt::format("{} is {}, expected {} to {}", key, value, low, high));
}

void add_texts(const ConfigValue& value, std::vector<std::string>& texts) {
  if (const auto* text = std::get_if<std::string>(&value.value)) texts.push_back(*text);
  if (const auto* items = std::get_if<ConfigValue::Array>(&value.value))
    for (const auto& item : *items) add_texts(item, texts);
  if (const auto* table = std::get_if<ConfigValue::Table>(&value.value))
    for (const auto& [key, item] : *table) add_texts(item, texts);
}

void check_sizes(const std::string& key, const ConfigValue& value, double smallest,
                 double largest) {
  if (const auto* number = std::get_if<double>(&value.value)) {
    const double size = std::abs(*number);
    if (std::isfinite(size) && size != 0 && !(size >= smallest && size <= largest))
      throw Error{fmt::format("{}: {} is {}, expected 0 or a size from {} to {}", value.where, key,
                              *number, smallest, largest)};
  }
  if (const auto* items = std::get_if<ConfigValue::Array>(&value.value))
    for (const auto& item : *items) check_sizes(key, item, smallest, largest);
  if (const auto* table = std::get_if<ConfigValue::Table>(&value.value))
    for (const auto& [inner, item] : *table) check_sizes(inner, item, smallest, largest);
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

void overlay(ConfigValue::Table& table, const ConfigValue::Table& changes) {
  for (const auto& [key, change] : changes) {
    ConfigValue& value = table[key];
    auto* const inner = std::get_if<ConfigValue::Table>(&value.value);
    const auto* const inner_changes = std::get_if<ConfigValue::Table>(&change.value);
    if (inner != nullptr && inner_changes != nullptr)
      overlay(*inner, *inner_changes);
    else
      value = change;
  }
}

// A text needs no quotes: --set map=sts.
ConfigValue parse_value(const std::string& value, const std::string& where) {
  try {
    return std::move(parse_toml("value = " + value, where).at("value"));
  } catch (const Error&) {
    if (!value.empty() && value.find_first_of("\"'[]{}\n") == std::string::npos)
      return {value, where};
    throw Error{fmt::format(
        "{}: the value is {}, expected a number, true, false, a text or a list such as [\"a\", "
        "\"b\"]; a shell needs quotes around it: '[\"a\", \"b\"]'",
        where, value.empty() ? "empty" : value)};
  }
}

}  // namespace

std::optional<std::string> nearest(const std::string& word,
                                   const std::vector<std::string>& candidates) {
  const std::size_t near_enough = word.size() / 3 + 1;
  std::optional<std::string> best;
  std::size_t best_distance = near_enough + 1;
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const auto meant = nearest(word, candidates);
  return meant ? fmt::format(" (did you mean '{}'?)", *meant) : "";
}

std::string did_you_mean_one_of(const std::string& word,
                                const std::vector<std::string>& candidates) {
  std::string hint = did_you_mean(word, candidates);
  if (!hint.empty()) return hint;
  return candidates.empty() ? "" : fmt::format(", expected one of {}", fmt::join(candidates, ", "));
}

Config::Config(ConfigValue::Table table, std::string where, std::filesystem::path directory)
    : table_{std::move(table)}, where_{std::move(where)}, directory_{std::move(directory)} {}

Config Config::load(const std::filesystem::path& file) {
  const std::string text = read_file(file, kMostConfigBytes);
  return Config{parse_toml(text, file.string()), file.string() + ":1:1", file.parent_path()};
}

Config Config::parse(std::string_view text, const std::string& name) {
  return Config{parse_toml(text, name), name + ":1:1", {}};
}

const ConfigValue* Config::find(const std::string& key) const {
  asked_.insert(key);
  const auto found = table_.find(key);
  return found == table_.end() ? nullptr : &found->second;
}

const ConfigValue& Config::require(const std::string& key) const {
  if (const ConfigValue* found = find(key)) return *found;
  for (const auto& [present, value] : table_) {
    if (asked_.count(present) > 0) continue;
    const std::string hint = did_you_mean(present, {key});
    if (!hint.empty())
      throw Error{fmt::format("{}: unknown key '{}'{}", value.where, present, hint)};
  }
  throw Error{fmt::format("{}: '{}' is missing", where_, key)};
}

bool Config::has(const std::string& key) const { return find(key) != nullptr; }

bool Config::is_table(const std::string& key) const {
  const auto found = table_.find(key);
  return found != table_.end() && std::holds_alternative<ConfigValue::Table>(found->second.value);
}

bool Config::is_array(const std::string& key) const {
  const auto found = table_.find(key);
  return found != table_.end() && std::holds_alternative<ConfigValue::Array>(found->second.value);
}

bool Config::is_text(const std::string& key) const {
  const auto found = table_.find(key);
  return found != table_.end() && std::holds_alternative<std::string>(found->second.value);
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, value] : table_) names.push_back(key);
  return names;
}

double Config::number(const std::string& key) const { return as_number(key, require(key)); }

std::int64_t Config::integer(const std::string& key) const {
  return as<std::int64_t>(key, require(key), "an integer");
}

std::string Config::text(const std::string& key) const {
  return as<std::string>(key, require(key), "a string");
}

std::vector<double> Config::numbers(const std::string& key) const {
  std::vector<double> result;
  for (const auto& item : as<ConfigValue::Array>(key, require(key), "an array of numbers"))
    result.push_back(as_number(key, item));
  return result;
}

std::vector<std::string> Config::texts(const std::string& key) const {
  std::vector<std::string> result;
  for (const auto& item : as<ConfigValue::Array>(key, require(key), "an array of strings"))
    result.push_back(as<std::string>(key, item, "a string"));
  return result;
}

std::vector<std::vector<double>> Config::rows(const std::string& key) const {
  std::vector<std::vector<double>> result;
  for (const auto& row : as<ConfigValue::Array>(key, require(key), "an array of rows")) {
    result.emplace_back();
    for (const auto& item : as<ConfigValue::Array>(key, row, "a row of numbers"))
      result.back().push_back(as_number(key, item));
    if (result.back().size() != result.front().size())
      throw Error{fmt::format("{}: {} has a row of {} numbers, the first has {}", row.where, key,
                              result.back().size(), result.front().size())};
  }
  return result;
}

Config Config::table(const std::string& key) const {
  const ConfigValue& found = require(key);
  return Config{as<ConfigValue::Table>(key, found, "a table"), found.where, directory_};
}

double Config::number(const std::string& key, double otherwise) const {
  return has(key) ? number(key) : otherwise;
}

std::int64_t Config::integer(const std::string& key, std::int64_t otherwise) const {
  return has(key) ? integer(key) : otherwise;
}

std::string Config::text(const std::string& key, const std::string& otherwise) const {
  return has(key) ? text(key) : otherwise;
}

bool Config::flag(const std::string& key, bool otherwise) const {
  return has(key) ? as<bool>(key, require(key), "true or false") : otherwise;
}

std::vector<double> Config::numbers(const std::string& key,
                                    const std::vector<double>& otherwise) const {
  return has(key) ? numbers(key) : otherwise;
}

std::vector<std::string> Config::texts(const std::string& key,
                                       const std::vector<std::string>& otherwise) const {
  return has(key) ? texts(key) : otherwise;
}

std::vector<Config> Config::tables(const std::string& key) const {
  std::vector<Config> result;
  if (!has(key)) return result;
  const std::string expected = fmt::format("tables, written [[{}]]", key);
  for (const auto& item : as<ConfigValue::Array>(key, require(key), expected))
    result.push_back(Config{as<ConfigValue::Table>(key, item, expected), item.where, directory_});
  return result;
}

Config Config::table_or_empty(const std::string& key) const {
  return has(key) ? table(key) : Config{{}, where_, directory_};
}

double Config::number_in(const std::string& key, double low, double high,
                         std::optional<double> otherwise) const {
  if (!has(key) && otherwise) return *otherwise;
  const double value = number(key);
  check_range(*this, key, value, low, high);
  return value;
}

std::int64_t Config::integer_in(const std::string& key, std::int64_t low, std::int64_t high,
                                std::optional<std::int64_t> otherwise) const {
  if (!has(key) && otherwise) return *otherwise;
  const std::int64_t value = integer(key);
  check_range(*this, key, value, low, high);
  return value;
}

void Config::limit_sizes(double smallest, double largest) const {
  for (const auto& [key, value] : table_) check_sizes(key, value, smallest, largest);
}

std::string Config::where(const std::string& key) const {
  const auto found = table_.find(key);
  return found == table_.end() ? where_ : found->second.where;
}

std::filesystem::path Config::resolve(const std::string& relative) const {
  const std::filesystem::path path{relative};
  return path.is_absolute() ? path : directory_ / path;
}

std::vector<std::filesystem::path> Config::named_files() const {
  std::vector<std::string> texts;
  for (const auto& [key, value] : table_) add_texts(value, texts);
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& text : texts)
    if (auto file = resolve(text); std::filesystem::is_regular_file(file, problem))
      files.push_back(std::move(file));
  return files;
}

void Config::fail(const std::string& key, const std::string& message) const {
  throw Error{where(key) + ": " + message};
}

namespace {

// A long list of keys does not help.
std::string hint_for(const std::string& key, const std::vector<std::string>& known) {
  constexpr std::size_t kMostListed = 16;
  return known.size() > kMostListed ? did_you_mean(key, known) : did_you_mean_one_of(key, known);
}

}  // namespace

void Config::reject_unknown_keys() const {
  for (const auto& [key, value] : table_) {
    if (asked_.count(key) > 0) continue;
    throw Error{fmt::format("{}: unknown key '{}'{}", value.where, key,
                            hint_for(key, {asked_.begin(), asked_.end()}))};
  }
}

Config Config::overlaid(const Config& changes) const {
  Config result = *this;
  result.asked_.clear();
  overlay(result.table_, changes.table_);
  return result;
}

Config Config::in_folder(const std::filesystem::path& folder) const {
  Config result = *this;
  result.directory_ = folder;
  return result;
}

Config Config::in_its_folder() const {
  return has("folder") ? in_folder(resolve(text("folder"))) : *this;
}

std::string Config::to_toml() const { return write_toml(table_); }

Config Config::without(const std::string& key) const {
  Config result = *this;
  result.asked_.clear();
  result.table_.erase(key);
  return result;
}

void Config::set(const std::string& dotted_key, const std::string& value) {
  const std::string where = fmt::format("--set {}", dotted_key);
  if (std::count(dotted_key.begin(), dotted_key.end(), '.') >= std::ptrdiff_t{kDeepest})
    throw Error{fmt::format("--set: a key has more than {} parts", kDeepest)};
  ConfigValue parsed = parse_value(value, where);
  ConfigValue::Table* table = &table_;
  std::size_t start = 0;
  for (std::size_t dot = dotted_key.find('.'); dot != std::string::npos;
       start = dot + 1, dot = dotted_key.find('.', start)) {
    ConfigValue& next = (*table)[dotted_key.substr(start, dot - start)];
    if (next.where.empty()) next = {ConfigValue::Table{}, where};
    table = std::get_if<ConfigValue::Table>(&next.value);
    if (table == nullptr)
      throw Error{fmt::format("{}: '{}' is {}, expected a table", where, dotted_key.substr(0, dot),
                              kind_of(next))};
  }
  parsed.where = where;
  (*table)[dotted_key.substr(start)] = std::move(parsed);
}

void Config::set(const std::string& key, const Config& table) {
  table_[key] = {table.table_, table.where_};
}

void Config::put(const std::string& key, double number) { table_[key] = {number, where_}; }
void Config::put(const std::string& key, const std::string& text) { table_[key] = {text, where_}; }

void Config::put(const std::string& key, const std::vector<double>& numbers) {
  ConfigValue::Array items;
  for (const double number : numbers) items.push_back({number, where_});
  table_[key] = {std::move(items), where_};
}

void Config::put(const std::string& key, const std::vector<std::string>& texts) {
  ConfigValue::Array items;
  for (const auto& text : texts) items.push_back({text, where_});
  table_[key] = {std::move(items), where_};
}

}  // namespace rths

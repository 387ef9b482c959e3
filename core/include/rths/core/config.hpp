// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <rths/core/error.hpp>

namespace rths {

/// One value of a TOML file and its position in the file.
struct ConfigValue {
  using Array = std::vector<ConfigValue>;
  using Table = std::map<std::string, ConfigValue>;
  std::variant<bool, std::int64_t, double, std::string, Array, Table> value;
  std::string where;  ///< "file:line:column"
};

/// A table of a TOML file. Keeps the file position of each value and the keys that were read.
///
/// Every getter throws `Error`: "file:line:column: found, expected". A key that no getter reads is
/// an error too, so a misspelt key cannot be ignored silently: call `reject_unknown_keys` after the
/// last getter. All functions @setup.
class Config {
 public:
  /// An empty table.
  Config() = default;
  /// Reads a file. @throws Error if the file cannot be read or is not TOML
  [[nodiscard]] static Config load(const std::filesystem::path& file);
  /// Reads text; messages show `name` as the file.
  [[nodiscard]] static Config parse(std::string_view text, const std::string& name);

  [[nodiscard]] bool has(const std::string& key) const;
  /// Type of a key's value. Does not count as reading the key.
  [[nodiscard]] bool is_table(const std::string& key) const;
  [[nodiscard]] bool is_array(const std::string& key) const;
  [[nodiscard]] bool is_text(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Required values.
  [[nodiscard]] double number(const std::string& key) const;
  [[nodiscard]] std::int64_t integer(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;
  /// Rows of numbers of equal length: [[1, 2], [3, 4]].
  [[nodiscard]] std::vector<std::vector<double>> rows(const std::string& key) const;
  [[nodiscard]] Config table(const std::string& key) const;

  /// Values with a default.
  [[nodiscard]] double number(const std::string& key, double otherwise) const;
  [[nodiscard]] std::int64_t integer(const std::string& key, std::int64_t otherwise) const;
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise) const;
  [[nodiscard]] bool flag(const std::string& key, bool otherwise) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& key,
                                            const std::vector<double>& otherwise) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key,
                                               const std::vector<std::string>& otherwise) const;
  /// The tables of `[[key]]`; empty if absent.
  [[nodiscard]] std::vector<Config> tables(const std::string& key) const;
  /// The table of `[key]`, an empty one if absent.
  [[nodiscard]] Config table_or_empty(const std::string& key) const;

  /// A number inside [low, high]. @throws Error naming both bounds
  [[nodiscard]] double number_in(const std::string& key, double low, double high,
                                 std::optional<double> otherwise = std::nullopt) const;
  [[nodiscard]] std::int64_t integer_in(const std::string& key, std::int64_t low, std::int64_t high,
                                        std::optional<std::int64_t> otherwise = std::nullopt) const;

  /// Checks the size of each number of this table and of the tables in it. Infinite numbers and NaN
  /// are left to the getters, and no key counts as read.
  /// @throws Error for a number that is not 0 and smaller than `smallest` or larger than `largest`
  void limit_sizes(double smallest, double largest) const;

  /// Position of the value, or of the table if the key is absent: "file:line:column".
  [[nodiscard]] std::string where(const std::string& key) const;
  [[nodiscard]] const std::string& where() const { return where_; }
  /// A path of this table as a full path: relative paths start at the folder of the TOML file.
  [[nodiscard]] std::filesystem::path resolve(const std::string& relative) const;
  /// The files that exist among the texts of this table and of the tables in it, as full paths. No
  /// key counts as read.
  [[nodiscard]] std::vector<std::filesystem::path> named_files() const;
  /// @throws Error "where(key): message"
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;
  /// Returns the result of `make`. Adds the position of `key` to an error that `make` throws.
  template <class Make>
  [[nodiscard]] auto placed(const std::string& key, Make make) const {
    try {
      return make();
    } catch (const Error& error) {
      fail(key, error.what());
    }
  }
  /// @throws Error for the first key that no getter has read, with the closest known key
  void reject_unknown_keys() const;

  /// This table with `changes` applied: tables are merged key by key, other values are replaced.
  [[nodiscard]] Config overlaid(const Config& changes) const;
  /// This table without one of its keys.
  [[nodiscard]] Config without(const std::string& key) const;

  /// This table with relative paths that start at another folder.
  [[nodiscard]] Config in_folder(const std::filesystem::path& folder) const;
  /// This table; if it has the key `folder`, relative paths start there.
  [[nodiscard]] Config in_its_folder() const;

  /// This table as TOML text that reads back the same: values first, then tables, keys in order.
  [[nodiscard]] std::string to_toml() const;

  /// Sets the value at a dotted path, as `--set` does. @param value  TOML text, or a text without
  /// quotes
  void set(const std::string& dotted_key, const std::string& value);
  /// Replaces the value of a key by a table.
  void set(const std::string& key, const Config& table);
  /// Replace the value of a key, in which dots have no meaning.
  void put(const std::string& key, double number);
  void put(const std::string& key, const std::string& text);
  void put(const std::string& key, const std::vector<double>& numbers);
  void put(const std::string& key, const std::vector<std::string>& texts);

 private:
  explicit Config(ConfigValue::Table table, std::string where, std::filesystem::path directory);
  [[nodiscard]] const ConfigValue* find(const std::string& key) const;
  [[nodiscard]] const ConfigValue& require(const std::string& key) const;

  ConfigValue::Table table_;
  std::string where_;
  std::filesystem::path directory_;
  mutable std::set<std::string> asked_;
};

/// The candidate closest to `word` in spelling: at most size / 3 + 1 letters differ.
[[nodiscard]] std::optional<std::string> nearest(const std::string& word,
                                                 const std::vector<std::string>& candidates);
/// Hint for an error message: " (did you mean 'x'?)", or "" if no candidate is close.
[[nodiscard]] std::string did_you_mean(const std::string& word,
                                       const std::vector<std::string>& candidates);
/// The same, or ", expected one of x, y" if no candidate is close.
[[nodiscard]] std::string did_you_mean_one_of(const std::string& word,
                                              const std::vector<std::string>& candidates);

}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/core/config.hpp>

namespace rths::launch {

/// A change of the command line: --set `key`=`value`.
struct Set {
  std::string key, value;
};

/// A key of an experiment and other values for it: the first one that the experiment accepts is
/// tried.
struct Key {
  std::string name;  ///< dotted; a key of the second table of [[a.b]] is "a.b[1].key"
  std::vector<Set> changes;
};

/// The keys of a file, those in tables and in lists of tables too.
[[nodiscard]] std::vector<Key> keys_of(const Config& file);

/// A list of tables as one value of TOML. @throws Error if one of them has a table
[[nodiscard]] std::string list_of_tables(const std::vector<Config>& tables);

}  // namespace rths::launch

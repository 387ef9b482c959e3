// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// The mistakes of a map, one line each.
class Mistakes {
 public:
  /// Runs a check and keeps its error. @returns whether it passed
  template <class Check>
  bool collect(const Check& check) {
    try {
      check();
      return true;
    } catch (const Error& error) {
      // A misspelt key is both missing and unknown.
      if (std::find(lines_.begin(), lines_.end(), error.what()) == lines_.end())
        lines_.emplace_back(error.what());
      return false;
    }
  }
  /// @throws Error with all lines, if there are any
  void report() const;

 private:
  std::vector<std::string> lines_;
};

/// Checks all rules of a memory map and keeps each one that is broken: "file:line:column: …".
/// Expects partitions and signals in order of offset.
void check_rules(const MapDescription& description, Mistakes& mistakes);

/// Sorts nodes by id, partitions, signals and values by position: one order for all spellings.
void sort_canonically(MapDescription& description);

}  // namespace rths::memmap

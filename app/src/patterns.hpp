// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fnmatch.h>

#include <algorithm>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

namespace rths::app {

/// True if a name matches a shell pattern (* and ?), or if there are no patterns.
inline bool matches(const std::string& name, const std::vector<std::string>& patterns) {
  return patterns.empty() ||
         std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
           return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
         });
}

/// The names that match at least one pattern, in their order.
/// @throws Error for the first pattern that matches no name
inline std::vector<std::string> selected(const std::vector<std::string>& names,
                                         const std::vector<std::string>& patterns) {
  for (const auto& pattern : patterns)
    if (std::none_of(names.begin(), names.end(),
                     [&](const std::string& name) { return matches(name, {pattern}); }))
      throw Error{"no signal of the recording matches '" + pattern + "'" +
                  did_you_mean(pattern, names)};
  std::vector<std::string> result;
  for (const auto& name : names)
    if (matches(name, patterns)) result.push_back(name);
  return result;
}

}  // namespace rths::app

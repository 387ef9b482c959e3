// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::app {

/// The names that match at least one pattern, in their order.
/// @param source  ring or recording, as messages name it
/// @throws Error for the first pattern that matches no name
inline std::vector<std::string> selected(const std::vector<std::string>& names,
                                         const std::vector<std::string>& patterns,
                                         const std::string& source) {
  for (const auto& pattern : patterns)
    if (std::none_of(names.begin(), names.end(),
                     [&](const std::string& name) { return matches(name, {pattern}); }))
      throw Error{fmt::format("{}: no signal matches '{}'{}", source, pattern,
                              did_you_mean(pattern, names))};
  std::vector<std::string> result;
  for (const auto& name : names)
    if (matches(name, patterns)) result.push_back(name);
  return result;
}

/// The signals of a ring that match at least one pattern, in the order of its map.
/// @throws Error as selected
inline std::vector<const memmap::SignalEntry*> selected_signals(
    const broker::Ring& ring, const std::string& name, const std::vector<std::string>& patterns) {
  std::vector<const memmap::SignalEntry*> signals;
  for (const auto& one : selected(ring.map().signal_names(), patterns, "ring '" + name + "'"))
    signals.push_back(&ring.map().entry(ring.map().signal(one)));
  return signals;
}

}  // namespace rths::app

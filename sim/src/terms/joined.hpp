// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include <rths/sim/term.hpp>

namespace rths::sim {

/// Joins the kinds of several files into one group.   @setup
inline std::vector<TermKind> joined(std::initializer_list<std::span<const TermKind>> files) {
  std::vector<TermKind> kinds;
  for (const auto& file : files) kinds.insert(kinds.end(), file.begin(), file.end());
  return kinds;
}

}  // namespace rths::sim

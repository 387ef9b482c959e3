// SPDX-License-Identifier: Apache-2.0
#include <rths/core/axis.hpp>

#include <algorithm>

namespace rths {

std::vector<std::string> names_of(std::span<const Axis> axes) {
  std::vector<std::string> names;
  for (const Axis axis : axes) names.emplace_back(name_of(axis));
  return names;
}

bool contains(std::span<const std::string> names, Axis axis) {
  return std::find(names.begin(), names.end(), name_of(axis)) != names.end();
}

std::array<bool, kHorizontal.size()> horizontal_among(std::span<const std::string> names) {
  return {contains(names, Axis::Long), contains(names, Axis::Lat)};
}

}  // namespace rths

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::scramnet {

/// Name of a node's image of a replicated ring; see broker/replicated. The operator, and programs
/// that only read, use the image with the name of the ring.
[[nodiscard]] inline std::string image_name(const std::string& ring, const std::string& node) {
  return node == "operator" || node.empty() ? ring : ring + "." + node;
}

}  // namespace rths::scramnet

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// Header for C programs: version, hash, node ids, and for every word its offset, its values' names
/// and the factor to SI. Needs nothing else.   @setup
[[nodiscard]] std::string generate_c(const Map& map);

/// The same for C++20 programs: one typed constant per word that decodes and encodes SI values.
/// Needs nothing but the standard library.   @setup
[[nodiscard]] std::string generate_cpp(const Map& map);

}  // namespace rths::memmap

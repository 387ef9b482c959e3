// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// Header for C programs: version, hash, node ids; for every word its offset, the names of its
/// values and the factor to SI. Includes no other header.   @setup
[[nodiscard]] std::string generate_c(const Map& map);

/// Header for C++20 programs: one typed constant per word, which decodes and encodes SI values.
/// Includes only the standard library.   @setup
[[nodiscard]] std::string generate_cpp(const Map& map);

}  // namespace rths::memmap

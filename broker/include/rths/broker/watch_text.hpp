// SPDX-License-Identifier: Apache-2.0
//
// Words and stores of a ring as text, for messages.
#pragma once

#include <string>

#include <rths/broker/watch.hpp>

namespace rths::broker {

/// The signal of a longword; "longword 505" if it has none.   @setup
[[nodiscard]] std::string word_name(const memmap::Map& map, LongwordOffset offset);
/// The value of a longword with its SI unit; as a number without one if it has no signal.   @setup
[[nodiscard]] std::string word_value(const memmap::Map& map, LongwordOffset offset,
                                     std::uint32_t word);
/// The processes that may have made a store that is not allowed: "opf (process 12)".   @setup
[[nodiscard]] std::string writers_of(const PlainStore& store);

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/cases/case.hpp>

#include "case_source.hpp"

namespace rths::diagnosis {

/// The key `name` of a table; without it `usual`.   @throws Error if it is empty   @setup
[[nodiscard]] std::string name_in(const Config& table, const std::string& usual);

/// Reads one [[record]].
/// @param channels  [channels] of the case; the record's own keys override it
/// @param is_machine  the axes are those of a test machine, and no displacement is beyond its reach
/// @throws Error with the position in case.toml or in the recording   @setup
[[nodiscard]] Record read_record(const Config& table, const Config& channels, Files& files,
                                 bool is_machine);

}  // namespace rths::diagnosis

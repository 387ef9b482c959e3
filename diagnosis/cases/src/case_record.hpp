// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/cases/case.hpp>

#include "case_source.hpp"

namespace rths::diagnosis {

/// Reads one [[record]].
/// @param channels  [channels] of the case; the record's own keys override it
/// @throws Error with the position in case.toml or in the recording   @setup
[[nodiscard]] Record read_record(const Config& table, const Config& channels, Files& files);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "segment.hpp"

namespace rths::broker {

/// Finishes what the writer of a group left unfinished: its last complete write, from its journal,
/// is brought into record and memory. For its successor, or anybody when its process has ended.
/// @returns true if there was something to finish
bool mend_group(Segment& segment, Group& group, const JournalPlace& journal);

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "segment.hpp"

namespace rths::broker {

/// Finishes what the writer of a group left unfinished: of record and memory, the one that is whole
/// is brought into the other, and into the journal if it is not there yet. For its successor.
void mend_group(Segment& segment, Group& group, JournalWriter& journal);

}  // namespace rths::broker

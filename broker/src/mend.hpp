// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "segment.hpp"

namespace rths::broker {

/// Finishes what the writer of a group left unfinished: of record and memory, the one that is whole
/// is brought into the other. For its successor.
/// @returns true if the journal lacks the group's last write
[[nodiscard]] bool mend_group(Segment& segment, Group& group, const JournalPlace& journal);

/// Puts a mended group into the journal.
void journal_mended_group(Segment& segment, Group& group, JournalWriter& journal);

}  // namespace rths::broker

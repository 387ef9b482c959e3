// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "segment.hpp"

namespace rths::broker {

/// Completes a group whose writer died in the middle of a write: copies the whole one of record and
/// memory into the other. Called by the writer's successor.
/// @returns true if the journal lacks the group's last write
[[nodiscard]] bool repair_group(const GroupView& group, const JournalView& journal);

/// Appends a repaired group to the journal.
void journal_repaired_group(const GroupView& group, JournalWriter& journal);

}  // namespace rths::broker

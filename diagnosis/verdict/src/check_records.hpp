// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Refuses records that are too short for a verdict, and values whose squares and products overflow
/// or vanish.
/// @throws Error with record, channel and sample   @setup
void check_records(const Case& c);

/// Refuses records that give a relation no error: too few compared rows, or outputs that are
/// constant. Of several outputs in one unit, one that varies is enough.
/// @throws Error with record and channel   @setup
void check_outputs(const Relation& relation, const std::vector<const Record*>& records);

}  // namespace rths::diagnosis

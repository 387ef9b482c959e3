// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Refuses records that are too short for a verdict, and values whose squares and products overflow
/// or vanish, and bearings in tension.
/// @throws Error with record, channel and sample   @setup
void check_records(const Case& c);

/// Says that the vertical force of a record is tension; empty: it is not, or was not recorded.
[[nodiscard]] std::string tension_in(const Record& record);

/// Refuses records that give a relation no error: too few compared rows, or outputs that are
/// constant. Of several outputs in one unit, one that varies is enough.
/// @throws Error with record and channel   @setup
void check_outputs(const Relation& relation, const std::vector<const Record*>& records);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Refuses a case that cannot be diagnosed, whatever its relations show.
/// @param without  terms that are not searched for   @throws Error   @setup
void check_case(const Case& c, const std::vector<std::string>& without);

/// Makes a relation of a case; null if the case lacks its channels.
using RelationOf = std::unique_ptr<Relation> (*)(const Case&, const std::vector<std::string>&);
/// Of a kind of model, in the order in which they are examined.
[[nodiscard]] std::vector<RelationOf> relations_of_kind(ModelKind kind);

/// @throws Error: the channels of the case belong to no relation   @setup
[[noreturn]] void throw_without_relation(const Case& c);

/// What was tested, in a word, where the records do not tell it from its machine; else empty.
[[nodiscard]] std::string specimen_of(const Case& given);

}  // namespace rths::diagnosis

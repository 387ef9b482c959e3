// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dynamic_model.hpp"

namespace rths::diagnosis {

// Shared by the readers of dynamic models. Errors: file:line:column.

/// Reads `hold`, `initial`, `steps_per_sample`, and [model.terms]: the simulation's terms, by
/// component.
void read_common(const Config& table, DynamicModel& model);

/// Reads the terms in the tables of `table`, which act on a component.
[[nodiscard]] std::vector<ModelTerm> read_model_terms(const Config& table,
                                                      const std::string& component);

/// A key and its text, "output.y" = "displacement.1".
struct RoleAssignment {
  std::string key;
  std::vector<std::string> words;  ///< of the text, between dots
};
/// All of [model.inputs] or [model.outputs]. @throws Error if the table is missing or empty
[[nodiscard]] std::vector<RoleAssignment> read_assignments(const Config& table);

/// Reads the text at `key` as a number from 1 to `most`; returns an index from 0.
/// @param name  of the numbered object, for messages
[[nodiscard]] Index read_index(const Config& table, const std::string& key, const std::string& word,
                               std::size_t most, const std::string& name);

/// Marks the keys that are read elsewhere as known, then rejects unknown keys.
void finish(const Config& table);

}  // namespace rths::diagnosis

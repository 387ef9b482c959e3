// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dynamic_model.hpp"

namespace rths::diagnosis {

// What readers of dynamic models have in common. Errors: file:line:column.

/// `hold`, `initial`, `steps_per_sample`, and [model.terms]: by component, what the simulation had.
void read_common(const Config& table, DynamicModel& model);

/// Terms in the tables of `table`, put at a component.
[[nodiscard]] std::vector<ModelTerm> read_model_terms(const Config& table,
                                                      const std::string& component);

/// A key and its text, "output.y" = "displacement.1".
struct Assignment {
  std::string key;
  std::vector<std::string> words;  ///< parts of the text between dots
};
/// All of [model.inputs] or [model.outputs]. @throws Error if it is missing or empty
[[nodiscard]] std::vector<Assignment> read_assignments(const Config& table);

/// A number from 1 to `most` in the text at `key`.
[[nodiscard]] Eigen::Index read_index(const Config& table, const std::string& key,
                                      const std::string& word, std::size_t most,
                                      const std::string& what);

/// A matrix as rows of numbers, or the CSV file that holds them.
[[nodiscard]] Eigen::MatrixXd read_matrix(const Config& table, const std::string& key);

/// Asks for what is read elsewhere, then rejects unknown keys.
void finish(const Config& table);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Inputs → outputs of a general dynamic system, in a free run: models of the kinds
/// mass_spring_damper, structure, linear and data. Formats: docs/diagnosis_models.md.
/// The case must outlive the relation.
/// @throws Error file:line:column if [model] is not such a system; Error if a record to fit lacks a
///         channel   @setup
[[nodiscard]] std::unique_ptr<Relation> dynamic_relation(
    const Case& c, const std::vector<std::string>& without = {});

}  // namespace rths::diagnosis

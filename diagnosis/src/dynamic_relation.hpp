// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/diagnosis/diagnose.hpp>

#include "relation.hpp"

namespace rths::diagnosis {

/// Inputs → outputs of a general dynamic system, run freely: models of the kinds
/// mass_spring_damper, structure, linear and data. Formats: docs/diagnosis_models.md.
/// @throws Error file:line:column if [model] is no such system, or Error if a record that is to be
///         fitted lacks a channel   @setup
[[nodiscard]] std::unique_ptr<Relation> dynamic_relation(const Case& c,
                                                         const DiagnosisOptions& options = {});

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/lattice.hpp>
#include <rths/identification/relation_findings.hpp>

namespace rths::diagnosis {

/// TOML of the named terms, and of the parameters fitted with them, for [specimen] and [machine] of
/// an experiment; empty if nothing was named. For models made of terms of the catalogue.
[[nodiscard]] std::string fragment_of(const RelationFindings& found);
/// The same of the named model with other values.
[[nodiscard]] std::string fragment_of(const RelationFindings& found, const Hypothesis& named);

/// Indices of the free parameters that belong to terms of the specimen.
[[nodiscard]] std::vector<Index> specimen_parameters(const Hypothesis& named);

/// Whether the model has the coarse steps of a sensor.
[[nodiscard]] bool has_rounding(const Case& c, const std::string& role);

/// [model] with the named terms, the coarse steps of sensors, and all parameters as fitted with
/// them. The parameters of the named terms are among `fitted`.
[[nodiscard]] Config improved_model(const Case& c,
                                    const std::vector<std::unique_ptr<RelationFindings>>& all,
                                    const std::vector<Lattice>& lattices);

/// The case with an improved model, and its experiment with the terms of `improved.toml`; empty if
/// the case was made in memory.
[[nodiscard]] CaseSource improved_case(const Case& c, const Config& model);

}  // namespace rths::diagnosis

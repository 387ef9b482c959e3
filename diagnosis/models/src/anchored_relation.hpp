// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// A relation whose predictions are anchored to the output of the user's own simulation:
///     prediction = model(hypothesis) − model(as stated) + output of the user's simulation
/// Integrator, time step and geometry of that simulation then count as no error. Its output is the
/// channel `predicted.<role>` of each record. Returns the relation unchanged, or null as given, if
/// no record has such a channel for one of its outputs, or if the model consists of the
/// prediction.   @setup
[[nodiscard]] std::unique_ptr<Relation> anchored(std::unique_ptr<Relation> relation, const Case& c);

}  // namespace rths::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// Replaces a case's model by the predictions of another simulation.
///
/// The first record to fit gets a channel `predicted.<role>` for each role that has a column in the
/// simulation. A column is named by the role ("force.long"), by "predicted." and the role, or as in
/// the recording of a run ("srmd.long.force.fbk", "displ.long"). Values are in SI. The column
/// "time" [s] has the same origin as the record. The record is cut to the span of the simulation.
/// Other records are removed, except references: the simulation does not predict their motions.
/// A model of kind `data` keeps its terms. A model with the key `anchor` stays.
/// @param simulation  text, HDF5 or MAT
/// @throws Error if the file cannot be read, has no time, or predicts no measured channel   @setup
[[nodiscard]] Case with_prediction(Case c, const std::filesystem::path& simulation);

}  // namespace rths::diagnosis

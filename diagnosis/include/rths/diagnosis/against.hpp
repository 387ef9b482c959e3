// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/diagnosis/case.hpp>

namespace rths::diagnosis {

/// Lets what another simulation predicted take the place of a case's model.
///
/// The first record to fit gets a channel `predicted.<role>` for each role that the simulation has
/// a column of, named as the role is ("force.long"), with "predicted." before it, or as a recording
/// of a run names it ("srmd.long.force.fbk", "displ.long"). Values are in SI; the column "time" [s]
/// counts from the same instant as the record. Samples that the simulation does not reach are cut
/// off. Records of other motions are left out: it says nothing about them.
/// @param simulation  text, HDF5 or MAT
/// @throws Error if the file cannot be read, has no time, or predicts nothing that was measured
///   @setup
[[nodiscard]] Case with_prediction(Case c, const std::filesystem::path& simulation);

}  // namespace rths::diagnosis

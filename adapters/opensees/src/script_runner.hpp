// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/adapters/child_program.hpp>
#include <rths/adapters/opensees_script.hpp>

namespace rths::adapters {

/// @throws Error if MPICH's program that starts ranks is missing. openseespy contains MPICH, so
///         ranks that another MPI starts do not see each other   @setup
void require_rank_launcher(int processes);

/// Lets a script run inside a few lines of Python, if it has several processors or floors.
///
/// With several processors, MPICH's launcher starts the ranks, and ends all when one fails, which
/// its last line names. A rank refuses, with one line: ranks that do not see each other, a
/// `genericClient` on another rank than 0, and at the first `analyze` a node whose mass is on
/// several ranks. Floors send their accelerations to a descriptor after each step: see FloorFeed.
/// @param start  of the script alone: interpreter, script, arguments; changed
/// @throws Error as require_rank_launcher
void run_inside(const OpenSeesScript& script, int floor_pipe, ProgramStart& start);

}  // namespace rths::adapters

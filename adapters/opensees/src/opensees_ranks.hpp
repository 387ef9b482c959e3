// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/adapters/child_program.hpp>

namespace rths::adapters {

/// @throws Error if MPICH's program that starts ranks is missing. openseespy contains MPICH, so
///         ranks that another MPI starts do not see each other   @setup
void require_rank_launcher(int processes);

/// Lets several ranks run a script: MPICH's launcher starts them, and ends all when one fails,
/// which its last line names. A rank refuses, with one line: ranks that do not see each other, a
/// `genericClient` on another rank than 0, and at the first `analyze` a node whose mass is on
/// several ranks.
/// @param start  of one process: interpreter, script, arguments; changed
/// @throws Error as require_rank_launcher
void start_on_ranks(int processes, ProgramStart& start);

}  // namespace rths::adapters

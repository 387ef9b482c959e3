// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>

namespace rths::scramnet {

using SignalHandler = void (*)(int, siginfo_t*, void*);

/// Handles SIGSEGV and SIGTRAP of this process. The program's own handlers of these, set before or
/// later by `sigaction` or `signal`, are kept beside: see `pass_on`.   @setup
void handle_faults(SignalHandler on_fault, SignalHandler on_step) noexcept;

/// Does with a signal what the program's own handler, or the default, would do. Called by a handler
/// of `handle_faults`, with its arguments.
void pass_on(int signal, siginfo_t* info, void* context) noexcept;

}  // namespace rths::scramnet

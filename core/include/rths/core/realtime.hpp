// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Written after the declaration of a function that may run inside a control loop: no heap, no
/// lock, no system call, no exception, every loop bounded. Each such function has a
/// `RealTimeGuard` test. Compilers that can check the claim themselves (clang 20 and later) do.
#if defined(__clang__) && __clang_major__ >= 20
#define RTHS_REALTIME noexcept [[clang::nonblocking]]
#else
#define RTHS_REALTIME noexcept
#endif

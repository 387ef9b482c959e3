// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the declaration of a function that may run inside a control loop: no heap, no lock, no
/// system call, no exception, every loop bounded. Tests guard such functions
/// by `EXPECT_REALTIME`; clang 20 and later also checks them at compile time.
#if defined(__clang__) && __clang_major__ >= 20
#define RTHS_REALTIME noexcept [[clang::nonblocking]]
#else
#define RTHS_REALTIME noexcept
#endif

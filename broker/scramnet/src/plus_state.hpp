// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

namespace rths::scramnet {

/// The card, if this process has its registers mapped; else null.
[[nodiscard]] Board* card_with_registers() noexcept;
/// The card, if this process has its memory mapped; else null.
[[nodiscard]] Board* card_with_memory() noexcept;

/// A new descriptor that `ioctl` knows; −1 if the system has none.
[[nodiscard]] int open_descriptor() noexcept;
/// What `ioctl` does on such a descriptor: −1 with errno, as system calls do.
[[nodiscard]] int control_card(unsigned long command, void* argument) noexcept;

}  // namespace rths::scramnet

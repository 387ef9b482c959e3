// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

namespace rths::scramnet {

/// The card if this process has mapped its registers; else null.
[[nodiscard]] Board* card_with_registers() noexcept;
/// The card if this process has mapped its memory; else null.
[[nodiscard]] Board* card_with_memory() noexcept;

/// Opens a descriptor of the card for `ioctl`; −1 if the system has none left.
[[nodiscard]] int open_descriptor() noexcept;
/// Implements `ioctl` on such a descriptor; −1 with errno on failure.
[[nodiscard]] int control_card(unsigned long command, void* argument) noexcept;

}  // namespace rths::scramnet

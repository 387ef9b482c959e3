// SPDX-License-Identifier: Apache-2.0
#include <rths/card/card.hpp>

#include <rths/card/gt_registers.hpp>
#include <rths/card/registers.hpp>

namespace rths::scramnet {

void power_up(Card& card, std::uint32_t index) {
  Registers{card}.power_up(default_id(index));
  power_up_gt(card.gt);
}

}  // namespace rths::scramnet

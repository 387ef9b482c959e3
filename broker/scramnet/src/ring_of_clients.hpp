// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/broker/ring.hpp>

#include "settings.hpp"

namespace rths::scramnet {

/// The ring of these settings, made if there is none. Unlike `Ring::create` it keeps a ring on
/// which nobody is: a card's memory outlives the programs that use it.
/// @throws Error if it can be neither attached nor made   @setup
[[nodiscard]] broker::Ring attach_or_make(const Settings& settings);

}  // namespace rths::scramnet

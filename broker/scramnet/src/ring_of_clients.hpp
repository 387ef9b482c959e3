// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/broker/ring.hpp>

#include "settings.hpp"

namespace rths::scramnet {

/// Attaches to the ring of these settings; creates it if there is none. Unlike `Ring::create`,
/// keeps a ring without processes: a card's memory outlives the programs that use it.
/// @throws Error if the ring can be neither attached nor created   @setup
[[nodiscard]] broker::Ring attach_or_make(const Settings& settings);

}  // namespace rths::scramnet

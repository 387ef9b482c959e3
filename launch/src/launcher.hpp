// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/broker/ring.hpp>

namespace rths::launch {

/// The launcher of a run among the occupants of its ring; null: there is none. In another PID
/// namespace, any living creator counts.
[[nodiscard]] const broker::Occupant* launcher_of(const broker::RingReport& report);

/// State of the ring of a run. @throws Error if there is no ring of that name that is usable
[[nodiscard]] broker::RingReport inspect_run(const std::string& ring);

/// The launcher of a run. @throws Error if there is none
[[nodiscard]] broker::Occupant known_launcher(const broker::RingReport& report);

}  // namespace rths::launch

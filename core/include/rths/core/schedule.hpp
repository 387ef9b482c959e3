// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/core/clock.hpp>
#include <rths/core/realtime.hpp>

namespace rths {

/// What a node does about the steps whose time passed while it, or the host, did not run.
enum class MissedSteps {
  Make,     ///< makes them at once, with the newest inputs
  MakeDue,  ///< makes them at once, each with the inputs of its own time
  Skip,     ///< goes on with the step that is due next
  Wait,     ///< the same, in turns with the nodes that it awaits: their time stands still together
};

/// Scheduled times of a node's steps: epoch + phase + k·period.
struct Schedule {
  Duration period{1'000'000};
  Duration phase{0};
  MissedSteps missed = MissedSteps::Make;

  /// Steps that a node leaves out which is so late; then the nearest one is due.   @realtime
  [[nodiscard]] std::uint64_t skipped_at(Duration late) const RTHS_REALTIME {
    const bool skips = missed == MissedSteps::Skip || missed == MissedSteps::Wait;
    return skips && late >= period ? static_cast<std::uint64_t>((late + period / 2) / period) : 0;
  }
};

/// A schedule from seconds.
[[nodiscard]] constexpr Schedule schedule_of(double period, double phase,
                                             MissedSteps missed = MissedSteps::Make) {
  return {from_seconds(period), from_seconds(phase), missed};
}

}  // namespace rths

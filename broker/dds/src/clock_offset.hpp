// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <rths/core/clock.hpp>

namespace rths::dds {

/// CLOCK_REALTIME minus CLOCK_MONOTONIC of this host.
[[nodiscard]] Duration real_time_offset();

/// Estimates the offset of another host's clock from the four times of a message and its answer
/// (RFC 5905, section 8). Keeps the last 64 exchanges and uses the one with the smallest error.
class ClockOffset {
 public:
  /// Adds an exchange. Times that cannot be true are ignored: another program may have made them.
  /// @param sent      of our message, on our clock
  /// @param received  of our message, on their clock
  /// @param answered  of their message, on their clock
  /// @param now       arrival of their message, on our clock
  void add(TimePoint sent, TimePoint received, TimePoint answered, TimePoint now);

  struct Estimate {
    Duration offset{0};  ///< their clock minus ours
    Duration error{0};   ///< the true offset differs by at most this
  };
  /// Empty before the first exchange.
  [[nodiscard]] std::optional<Estimate> at(TimePoint now) const;

 private:
  struct Exchange {
    Duration offset{0}, round_trip{0};
    TimePoint time{0};
  };
  std::array<Exchange, 64> exchanges_;
  std::size_t count_ = 0;  ///< of all exchanges
};

}  // namespace rths::dds

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace rths::loop {

/// Times of the ticks of a node, since a common start [s].
struct TickTimes {
  std::vector<double> begin;  ///< the node reads its inputs
  std::vector<double> end;    ///< its outputs are written
  /// Ticks that were made after their time, with the inputs of their time, and when they were due.
  /// Their outputs count from then on for other such ticks. Both may be empty.
  std::vector<bool> missed = {};  // NOLINT(readability-redundant-member-init)
  std::vector<double> due = {};   // NOLINT(readability-redundant-member-init)

  [[nodiscard]] bool is_missed(std::size_t tick) const {
    return tick < missed.size() && missed[tick];
  }
};

/// The order in which controller and machine made their ticks. Ticks beyond the vectors, and all if
/// they are empty, are on time: in each period, the machine moves before the controller.
struct TickOrder {
  std::vector<std::size_t> machine_before;     ///< ticks of the machine, by tick of the controller
  std::vector<std::size_t> controller_before;  ///< ticks of the controller, by tick of the machine
  std::vector<bool> missed;                    ///< by tick of the controller: its command waited

  [[nodiscard]] std::size_t machine_ticks(std::size_t controller_tick) const {
    return controller_tick < machine_before.size() ? machine_before[controller_tick]
                                                   : controller_tick + 1;
  }
  [[nodiscard]] std::size_t controller_ticks(std::size_t machine_tick) const {
    return machine_tick < controller_before.size() ? controller_before[machine_tick] : machine_tick;
  }
  [[nodiscard]] bool is_missed(std::size_t controller_tick) const {
    return controller_tick < missed.size() && missed[controller_tick];
  }
};

/// @returns an empty order if all ticks were on time   @setup
[[nodiscard]] TickOrder order_of(const TickTimes& machine, const TickTimes& controller);

/// The tick of the controller in which a target arrived: one from first to last. A recording with
/// missing rows does not tell which.
struct Arrival {
  std::size_t first = 0, last = 0;
};

/// When the nodes of a test made their ticks, and when its targets arrived.
struct Host {
  TickOrder order;
  std::vector<Arrival> arrivals;  ///< by target; later targets arrive after `computing`
  /// Controller ticks from "at target" to the arrival of the next target, by step; the last value
  /// holds for later steps. Empty: 1.
  std::vector<int> computing;
  std::size_t first_target = 1;  ///< controller tick in which the first target arrives

  /// Controller tick in which the first target arrives.
  [[nodiscard]] std::size_t first_arrival() const {
    return arrivals.empty() ? first_target : arrivals[0].last;
  }
  /// Controller tick in which the target `next` arrives if the one before was reached in `tick`.
  [[nodiscard]] std::size_t arrival(std::size_t next, std::size_t tick) const;
};

}  // namespace rths::loop

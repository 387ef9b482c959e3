// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::adapters {

/// When an adapter's steps are due: at epoch + phase + k·period.
struct Schedule {
  Duration period{1'000'000};
  Duration phase{0};
};

/// How late a step began and how long the one before it took; both zero in virtual time.
struct Timing {
  Duration late{0};
  Duration duration{0};
  bool is_early = false;  ///< there was news: it counts as no step of the schedule
};

/// What every node tells of itself, first in its monitor partition: see `AdapterRunner`.
[[nodiscard]] std::vector<Port> runner_ports();

/// An adapter at its place on the ring: reads its inputs, runs its step, writes its outputs.
///
/// A value that is no number passes in neither direction: the last one stands, and the step's
/// status says Stale for an input, LimitExceeded for an output.
///
/// Adds to the adapter's monitors what every node tells of itself: host.step, host.status,
/// host.overruns, host.stale, host.late (of this step) and host.late_max (of all), host.duration.
class AdapterRunner {
 public:
  /// @param node  name in the ring's map
  /// @throws Error if the ring lacks a signal, belongs to another map, or has that node already
  /// @setup
  AdapterRunner(Adapter& adapter, broker::Ring& ring, const std::string& node,
                std::uint64_t map_hash, Duration period);

  /// One step. @param time  as scheduled, since the run began   @realtime
  [[nodiscard]] Status tick(Duration time, bool stopping, const Timing& timing) RTHS_REALTIME;

  /// Returns at `time`, or when there is news that the adapter waits for.   @realtime, but for the
  /// sleep
  void wait_until(TimePoint time, Clock& clock) RTHS_REALTIME;

  [[nodiscard]] const char* message() const { return step_.message; }
  [[nodiscard]] std::uint64_t overruns() const { return overruns_; }
  [[nodiscard]] broker::Node& node() { return node_; }
  /// Nodes whose words this adapter reads, other than its own.
  [[nodiscard]] const std::vector<std::string>& peers() const { return peers_; }

 private:
  /// A tear group or a lone word, with the values it carries.
  struct Value {
    std::uint32_t index;  ///< in the adapter's inputs or outputs
    std::uint32_t word;   ///< in the group's image
    memmap::Codec codec;
  };
  struct Transfer {
    LongwordOffset base;
    bool is_group = false;
    TearGroupId group;
    std::vector<std::uint32_t> image;
    std::vector<Value> values;
  };
  void bind(const std::vector<Port>& ports, broker::Ring& ring, const std::string& node);
  [[nodiscard]] static Transfer& transfer_for(std::vector<Transfer>& transfers,
                                              const memmap::SignalEntry& entry,
                                              const broker::Ring& ring);
  [[nodiscard]] Status read_inputs() noexcept;
  [[nodiscard]] Status write_outputs() noexcept;
  void tell_of_itself(Status status, const Timing& timing) noexcept;

  Adapter& adapter_;
  broker::Node node_;
  Duration period_;
  std::vector<std::string> peers_;
  void wait_for_inputs(TimePoint time) noexcept;
  std::vector<Transfer> reads_, writes_;
  std::optional<broker::Waiter> waiter_;  ///< for writes to the inputs; none: there are no inputs
  std::vector<double> inputs_, outputs_;
  StepData step_;
  std::uint64_t steps_ = 0, overruns_ = 0, stale_ = 0;
};

/// Name of the signal that a port of `node` is bound to.
[[nodiscard]] std::string signal_name(const Port& port, const std::string& node);

/// Why a host loop ended.
struct LoopEnd {
  Status status = Status::Ok;  ///< Done or Fault
  Duration time{0};            ///< of the last step
};

/// Runs a host on a clock until its adapter is done or at fault: when a step is due, and when there
/// is news that the adapter waits for. A late step is run at once, and
/// those that were missed are made up for: the machine moved on meanwhile.
/// @param stopping  may be set by any thread at any time
[[nodiscard]] LoopEnd run_loop(AdapterRunner& runner, Clock& clock, TimePoint epoch,
                               const Schedule& schedule,
                               const std::atomic<bool>& stopping) RTHS_REALTIME;

}  // namespace rths::adapters

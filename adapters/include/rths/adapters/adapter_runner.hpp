// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/schedule.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::adapters {

/// Delay of a step's start and duration of the previous step; both zero in virtual time.
struct Timing {
  Duration late{0};
  Duration duration{0};
  bool is_early = false;         ///< started by a Wake event: not counted as a scheduled step
  std::uint64_t skipped = 0;     ///< steps left out before this one
  const Clock* clock = nullptr;  ///< null in virtual time
  TimePoint due{0};              ///< scheduled start of the step on this clock
};

/// Times of the scheduled steps of a node, in order [s].
struct StepTimes {
  std::vector<float> late;      ///< start after the scheduled time
  std::vector<float> duration;  ///< until its outputs are written
};

/// A step waits at most so long for that of an awaited node.
inline constexpr Duration kLongestAwaited = std::chrono::milliseconds{200};
inline constexpr Duration kAwaitedNap = std::chrono::microseconds{50};  ///< between two looks at it

/// Monitors that every node writes, at the start of its monitor partition: see `AdapterRunner`.
[[nodiscard]] std::vector<Port> runner_ports();

/// Runs an adapter on its node of the ring: reads its inputs, runs its step, writes its outputs.
///
/// NaN and infinite values, and values outside the range of a parameter, are dropped and the last
/// valid value is held. The step's status is then Stale for an input, LimitExceeded for an output.
/// If the memory of the ring is lost, all inputs are held and the adapter is stopped.
///
/// Adds these monitors to the adapter's own: host.step, host.status, host.overruns, host.stale,
/// host.late (this step), host.late_max (all steps), host.duration,
/// host.invalid (inputs read and values written that were not numbers),
/// host.skipped (steps left out, because their time had passed).
class AdapterRunner {
 public:
  /// @param node  name in the ring's map
  /// @throws Error if the ring lacks a signal, uses another map, or already has this node
  /// @setup
  AdapterRunner(Adapter& adapter, broker::Ring& ring, const std::string& node,
                std::uint64_t map_hash, const Schedule& schedule);

  /// Runs one step. @param time  scheduled, since the start of the run   @realtime
  [[nodiscard]] Status tick(Duration time, bool stopping, const Timing& timing) RTHS_REALTIME;

  /// From now on, each step of this node awaits one that another node has made since the last step:
  /// a simulated machine and its controller, on one host, whose time can wait.
  /// @param goes_first  this node makes the first step
  /// @throws Error if the other node has no monitors   @setup
  void await_steps_of(const std::string& node, bool goes_first, broker::Ring& ring);
  /// Whether an awaited node has not made its step yet.   @realtime
  [[nodiscard]] bool is_awaiting() const RTHS_REALTIME;
  /// Goes on without a node that made no step, until it makes one again.   @realtime
  void give_up_awaiting() RTHS_REALTIME;

  /// Keeps the times of this many scheduled steps from now on.   @setup
  void keep_times(std::size_t steps);
  /// To be called after each step, with its own duration. Does nothing for early steps, without
  /// `keep_times`, and when as many are kept.   @realtime
  void keep(const Timing& timing) RTHS_REALTIME;
  [[nodiscard]] const StepTimes& times() const { return times_; }

  /// Waits until `time` or the adapter's Wake event.   @realtime, except for the sleep
  void wait_until(TimePoint time, Clock& clock) RTHS_REALTIME;
  /// Waits at most `kLongestAwaited` for the awaited steps.   @realtime, except for the sleep
  void wait_for_others(Clock& clock) RTHS_REALTIME;

  [[nodiscard]] const char* message() const { return step_.message; }
  /// Why the adapter asks for the end of the run while it comes to rest; empty: it does not.
  /// Any thread.
  [[nodiscard]] const char* stop_request() const RTHS_REALTIME {
    return std::atomic_ref{stop_request_}.load(std::memory_order_acquire);
  }
  [[nodiscard]] std::uint64_t overruns() const { return overruns_; }
  [[nodiscard]] const Schedule& schedule() const { return schedule_; }
  [[nodiscard]] broker::Node& node() { return node_; }

 private:
  struct Value {
    std::uint32_t index;  ///< in the adapter's inputs or outputs
    std::uint32_t word;   ///< in the group's image
    memmap::Codec codec;
    double lowest, highest;  ///< of a parameter with a range, rounded as in its word; else infinite
    bool is_parameter;

    [[nodiscard]] bool accepts(double value) const noexcept {
      return std::isfinite(value) && value >= lowest && value <= highest;
    }
  };
  /// A tear group or a single word, with the values it carries.
  struct Transfer {
    LongwordOffset base;
    bool is_group = false;
    bool is_monitor = true;  ///< all its values are monitors
    TearGroupId group;
    std::vector<std::uint32_t> image;
    std::vector<Value> values;
  };
  void bind(const std::vector<Port>& ports, broker::Ring& ring, const std::string& node);
  [[nodiscard]] static Value value_for(const Port& port, const memmap::SignalEntry& entry,
                                       std::size_t index, LongwordOffset base);
  [[nodiscard]] static Transfer& transfer_for(std::vector<Transfer>& transfers,
                                              const memmap::SignalEntry& entry,
                                              const broker::Ring& ring);
  [[nodiscard]] Status read_inputs(const Timing& timing) noexcept;
  [[nodiscard]] Status read_newest() noexcept;
  [[nodiscard]] Status read_until(TimePoint time) noexcept;
  void keep(const broker::Write& write) noexcept;
  [[nodiscard]] Status take(const Transfer& transfer) noexcept;
  [[nodiscard]] Status write_outputs() noexcept;
  void write_own_monitors(Status status, const Timing& timing) noexcept;

  Adapter& adapter_;
  broker::Node node_;
  Schedule schedule_;
  void wait_for_inputs(TimePoint time) noexcept;
  std::vector<Transfer> reads_, writes_;
  std::optional<broker::Waiter> waiter_;  ///< for writes to the inputs; empty without inputs
  /// Of the nodes that write the inputs, if missed steps are made with those of their own time.
  std::vector<broker::Follower> followers_;
  /// A node whose steps are awaited.
  struct Awaited {
    LongwordOffset steps;  ///< its count
    memmap::Codec codec;
    double seen;  ///< the count at the last step of this node
    bool is_given_up = false;
  };
  [[nodiscard]] bool is_awaiting(const Awaited& awaited) const noexcept;
  [[nodiscard]] double steps_of(const Awaited& awaited) const noexcept;
  std::vector<Awaited> awaited_;
  std::vector<double> inputs_, outputs_;
  StepData step_;
  std::uint64_t steps_ = 0, overruns_ = 0, stale_ = 0, invalid_ = 0, skipped_ = 0;
  mutable const char* stop_request_ = "";
  StepTimes times_;
};

/// Returns the signal name of a port of `node`.
[[nodiscard]] std::string signal_name(const Port& port, const std::string& node);

/// Checks that a map has the signals of a node's ports, in their units, and that the node may write
/// its outputs.
/// @throws Error for the first port that does not fit   @setup
void check_ports(const std::vector<Port>& ports, const memmap::Map& map, const std::string& node);

/// Result of `run_loop`.
struct LoopEnd {
  Status status = Status::Ok;  ///< Done or Fault
  Duration time{0};            ///< of the last step
};

/// Runs a runner's steps on a clock until its adapter returns Done or Fault.
///
/// A step starts at its scheduled time, or earlier on the adapter's Wake event. A late step starts
/// at once; the schedule says what becomes of missed ones.
/// @param stopping  may be set by any thread at any time
[[nodiscard]] LoopEnd run_loop(AdapterRunner& runner, Clock& clock, TimePoint epoch,
                               const std::atomic<bool>& stopping) RTHS_REALTIME;

}  // namespace rths::adapters

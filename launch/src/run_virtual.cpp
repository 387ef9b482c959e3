// SPDX-License-Identifier: Apache-2.0
//
// A run in virtual time: all adapters are stepped in the order of their due times. On one host they
// are in this process, on a ring in private memory. On several hosts, each makes the steps of its
// nodes and waits for those of the others. No step reads a clock, so the same experiment gives the
// same bits. A step can be made late on purpose.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/launch/run.hpp>

#include "host_link.hpp"
#include "interrupt.hpp"
#include "launcher_link.hpp"
#include "peer_watch.hpp"
#include "run_modes.hpp"

namespace rths::launch {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{100};

// A word of a turn: the number of steps in the upper 30 bits, 12 days at 1 kHz, and the end of the
// node in the lower two.
constexpr std::uint32_t kEndBits = 2;

enum TurnsEnd : std::uint32_t { kGoesOn, kDone, kFault };

std::uint32_t end_of(Status status) {
  if (status == Status::Done) return kDone;
  return status == Status::Fault ? kFault : kGoesOn;
}

std::vector<broker::LongwordRange> words_of(const memmap::Map& map, const Experiment& experiment) {
  std::vector<broker::LongwordRange> words;
  for (const auto& plan : experiment.nodes)
    for (const auto& partition : map.partitions())
      if (partition.name == turn_partition(plan.node)) words.push_back({partition.base, 1});
  return words;
}

// The status of a step by the word of its node; empty: not made yet. The other host is ahead if no
// step of this host comes in between.
std::optional<Status> status_of(std::uint32_t step, std::uint32_t word) {
  const std::uint32_t steps = word >> kEndBits, end = word & ((1U << kEndBits) - 1);
  if (steps < step) return std::nullopt;
  if (steps > step || end == kGoesOn) return Status::Ok;
  return end == kDone ? Status::Done : Status::Fault;
}

/// The order of the steps of all hosts in virtual time. Each node writes the number of its steps
/// after the results of its step, so a host that reads this number has the results.
class Turns {
 public:
  Turns(broker::Ring& ring, const Experiment& experiment, HostLink& link)
      : reader_{ring.observe()},
        waiter_{ring.wait_for(words_of(ring.map(), experiment))},
        link_{link} {
    const auto words = words_of(ring.map(), experiment);
    for (std::size_t i = 0; i < words.size(); ++i)
      turns_[experiment.nodes[i].node] = {words[i].begin, 0};
  }

  /// Result of the next step of a node of another host.
  struct Waited {
    std::optional<Status> status;  ///< empty: the other host did not make the step
    std::string trouble;           ///< why
  };
  [[nodiscard]] Waited wait_for(const std::string& node) {
    const WallClock clock;
    Turn& turn = turns_.at(node);
    ++turn.steps;
    for (;;) {
      if (const auto status = status_of(turn.steps, reader_.read(turn.word))) return {status, ""};
      broker::Write ignored{};
      if (waiter_.wait(clock.now() + kLook, ignored) == Status::Ok) continue;
      if (InterruptGuard::is_interrupted()) return {{}, "interrupted"};
      if (InterruptGuard::is_stop_requested()) return {{}, "stopped on request"};
      if (const auto trouble = link_.find_trouble()) return {{}, *trouble};
    }
  }

  /// Tells the other hosts that a node of this host made its step.
  void pass_on(broker::Node& writer, const std::string& node, Status status) {
    Turn& turn = turns_.at(node);
    ++turn.steps;
    static_cast<void>(writer.write(turn.word, turn.steps << kEndBits | end_of(status)));
  }

 private:
  struct Turn {
    LongwordOffset word;
    std::uint32_t steps = 0;
  };
  broker::Node reader_;
  broker::Waiter waiter_;
  HostLink& link_;
  std::map<std::string, Turn> turns_;  ///< by node
};

constexpr Duration kProgressPeriod = std::chrono::milliseconds{500};
constexpr Duration kLongestFarewell = std::chrono::seconds{5};

/// A node of the test; on another host without a runner.
struct Runner {
  const Station* station;
  std::unique_ptr<adapters::AdapterRunner> runner;
  Duration due;
  Duration start;             ///< of its next step
  std::uint64_t skipped = 0;  ///< steps before it that are left out
  bool finished = false;
  std::unique_ptr<PeerWatch> peers = nullptr;  ///< on a ring of cards
  Duration next_look{0};
};

Runner* next_due(std::vector<Runner>& runners) {
  Runner* next = nullptr;
  for (auto& runner : runners)
    if (!runner.finished && (next == nullptr || runner.start < next->start)) next = &runner;
  return next;
}

using RingOf = std::function<broker::Ring&(const std::string& node)>;

class VirtualRun {
 public:
  /// @param ring_of  the ring of a node
  /// @param turns  order of the steps of all hosts; null on one host
  VirtualRun(const Experiment& experiment, Assembly& assembly, const RunOptions& options,
             const RingOf& ring_of, Turns* turns)
      : experiment_{experiment}, options_{options}, turns_{turns} {
    for (auto& station : assembly.stations) {
      const bool is_here = turns == nullptr || station.plan.host == options.host;
      if (is_here) station.adapter->activate();
      runners_.push_back(
          {&station, is_here ? runner_of(station, assembly, ring_of(station.plan.node)) : nullptr,
           station.plan.schedule.phase, Duration{0}});
      schedule(runners_.back());
      if (options.lateness && runners_.back().runner)
        runners_.back().runner->keep_times(steps_of(experiment, station.plan));
    }
  }

  /// Carries the messages of cards before and after each step.
  void carry(replicated::Images& images, const memmap::Map& map) {
    images_ = &images;
    for (auto& runner : runners_)
      runner.peers = std::make_unique<PeerWatch>(runner.runner->node(), map, experiment_,
                                                 runner.station->plan.node);
  }

  std::string run() {
    if (options_.started) options_.started();
    while (Runner* runner = next_due(runners_)) {
      if (postpones(*runner) || skips(*runner)) continue;
      if (images_ != nullptr) images_->advance(runner->start);
      const auto status = step(*runner);
      if (images_ != nullptr) images_->advance(runner->start);
      look_for_peers(*runner);
      look_for_interrupt(*runner);
      look_for_end(*runner);
      if (!status) return trouble_;
      if (*status == Status::Done || *status == Status::Fault) end(*runner, *status);
      if (stopping_since_ && runner->due > *stopping_since_ + longest_stop(experiment_))
        return "a node did not come to rest";
      report_progress(runner->due);
      runner->due += runner->station->plan.schedule.period;
      schedule(*runner);
    }
    return trouble_;
  }

  [[nodiscard]] bool was_interrupted() const { return was_interrupted_; }

  [[nodiscard]] std::map<std::string, adapters::StepTimes> times() const {
    std::map<std::string, adapters::StepTimes> times;
    for (const auto& runner : runners_)
      if (options_.lateness && runner.runner)
        times[runner.station->plan.node] = runner.runner->times();
    return times;
  }

 private:
  [[nodiscard]] std::unique_ptr<adapters::AdapterRunner> runner_of(const Station& station,
                                                                   const Assembly& assembly,
                                                                   broker::Ring& ring) const {
    auto runner = std::make_unique<adapters::AdapterRunner>(
        *station.adapter, ring, station.plan.node, assembly.map.hash(), station.plan.schedule);
    await_others(experiment_, station.plan, *runner, ring);
    return runner;
  }

  // A late step delays those that follow until their time has come.
  void schedule(Runner& runner) const {
    const Duration late =
        options_.lateness ? options_.lateness(runner.station->plan.node, runner.due) : Duration{0};
    runner.start = std::max(runner.start, runner.due + std::max(late, Duration{0}));
  }

  // Leaves out the steps whose time has passed. Returns whether the next one is not due yet.
  bool skips(Runner& runner) const {
    const auto& schedule = runner.station->plan.schedule;
    const std::uint64_t skipped = schedule.skipped_at(runner.start - runner.due);
    runner.skipped += skipped;
    runner.due += static_cast<Duration::rep>(skipped) * schedule.period;
    const bool is_early = runner.start < runner.due;
    runner.start = std::max(runner.start, runner.due);
    return is_early;
  }

  // A step that awaits one of a late node comes after it.
  bool postpones(Runner& runner) {
    if (!runner.runner || stopping_since_ || !runner.runner->is_awaiting()) return false;
    const Runner* next = nullptr;
    for (const NodePlan* awaited : awaited_by(experiment_, runner.station->plan))
      for (const auto& other : runners_)
        if (other.station->plan.node == awaited->node && !other.finished &&
            (next == nullptr || other.start < next->start))
          next = &other;
    const bool waits = next != nullptr && next->start < runner.due + adapters::kLongestAwaited;
    if (waits)
      runner.start = std::max(runner.start, next->start) + adapters::kAwaitedNap;
    else
      runner.runner->give_up_awaiting();
    return waits;
  }

  // Empty if another host did not make its step.
  std::optional<Status> step(Runner& runner) {
    const std::string& node = runner.station->plan.node;
    if (!runner.runner) {
      const auto waited = turns_->wait_for(node);
      if (!waited.trouble.empty()) trouble_ = waited.trouble;
      return waited.status;
    }
    adapters::Timing timing;
    if (options_.lateness) {
      clock_.sleep_until(runner.start);
      timing.late = runner.start - runner.due;
      timing.skipped = runner.skipped;
      timing.clock = &clock_;
      timing.due = runner.due;
    }
    runner.skipped = 0;
    const Status status = runner.runner->tick(runner.due, stopping_since_.has_value(), timing);
    runner.runner->keep(timing);
    look_for_request(runner, status);
    if (turns_ != nullptr) turns_->pass_on(runner.runner->node(), node, status);
    return status;
  }

  // An adapter can ask for the end of the run before it has come to rest.
  void look_for_request(const Runner& runner, Status status) {
    const std::string request = runner.runner->stop_request();
    if (stopping_since_ || request.empty() || status == Status::Fault) return;
    stopping_since_ = runner.due;
    trouble_ = fmt::format("{}: {}", runner.station->plan.node, request);
  }

  // Cards can part a node from its peers; then it stops the run.
  void look_for_peers(Runner& runner) {
    if (!runner.peers || stopping_since_ || runner.due < runner.next_look) return;
    runner.next_look = runner.due + kLookPeriod;
    const auto trouble = runner.peers->find_trouble(runner.due);
    if (!trouble) return;
    stopping_since_ = runner.due;
    trouble_ = fmt::format("{}: {} at {:.3f} s", runner.station->plan.node, *trouble,
                           to_seconds(runner.due));
  }

  // All nodes come to rest, and the recording is complete up to then.
  void look_for_interrupt(const Runner& runner) {
    if (stopping_since_ || !is_interrupted()) return;
    stopping_since_ = runner.due;
    trouble_ = "interrupted";
    was_interrupted_ = true;
  }

  // A solver of the user's own may never end the test.
  void look_for_end(const Runner& runner) {
    const auto latest = experiment_.latest_end();
    if (stopping_since_ || !latest || runner.due <= from_seconds(*latest)) return;
    stopping_since_ = runner.due;
    trouble_ = late_end(experiment_, to_seconds(runner.due));
  }

  void end(Runner& runner, Status status) {
    runner.finished = true;
    if (!stopping_since_) stopping_since_ = runner.due;
    if (status != Status::Fault || !trouble_.empty()) return;
    const auto& plan = runner.station->plan;
    trouble_ = runner.runner ? fmt::format("{}: {} at {:.3f} s", plan.node,
                                           runner.runner->message(), to_seconds(runner.due))
                             : fmt::format("{} on host '{}': a fault at {:.3f} s", plan.node,
                                           plan.host, to_seconds(runner.due));
  }

  void report_progress(Duration now) {
    if (!options_.progress || now < next_progress_) return;
    next_progress_ = now + kProgressPeriod;
    options_.progress({to_seconds(now) / experiment_.time.rate, experiment_.time.duration});
  }

  const Experiment& experiment_;
  const RunOptions& options_;
  Turns* turns_;
  replicated::Images* images_ = nullptr;
  VirtualClock clock_;
  std::vector<Runner> runners_;
  std::optional<Duration> stopping_since_;
  bool was_interrupted_ = false;
  Duration next_progress_{0};
  std::string trouble_;
};

RunEnd run_on_one_host(const Experiment& experiment, Assembly& assembly,
                       const RunOptions& options) {
  std::optional<replicated::Images> images;
  std::optional<broker::Ring> shared;
  if (assembly.cards)
    images.emplace(replicated::Images::in_process(assembly.map, *assembly.cards));
  else
    shared.emplace(broker::Ring::in_process(assembly.map));
  VirtualRun run{
      experiment, assembly, options,
      [&](const std::string& node) -> broker::Ring& { return images ? images->of(node) : *shared; },
      nullptr};
  if (images) run.carry(*images, assembly.map);
  RunEnd result;
  result.trouble = run.run();
  result.interrupted = run.was_interrupted();
  if (images) add_faults(images->events(), result);
  result.times = run.times();
  return result;
}

// The nodes of the other hosts step there, in the same order.
std::string run_on_several_hosts(const Experiment& experiment, Assembly& assembly,
                                 const RunOptions& options) {
  const InterruptGuard guard;
  broker::Ring ring = broker::Ring::create(options.ring, assembly.map);
  const RunCleaning cleaning{options};
  HostLink link{ring, experiment, options};
  std::string trouble;
  try {
    Turns turns{ring, experiment, link};
    VirtualRun run{experiment, assembly, options,
                   [&](const std::string&) -> broker::Ring& { return ring; }, &turns};
    link.wait_until_ready(InterruptGuard::is_called_off);
    trouble = InterruptGuard::is_called_off() ? "interrupted" : run.run();
  } catch (const Error& error) {
    link.publish(HostState::Failed, error.what());
    link.wait_until_ended(kLongestFarewell);
    throw;
  }
  link.publish(trouble.empty() ? HostState::Completed : HostState::Failed, trouble);
  link.wait_until_ended(kLongestFarewell);
  return trouble;
}

}  // namespace

RunEnd run_in_virtual_time(const Experiment& experiment, Assembly& assembly,
                           const RunOptions& options) {
  for (const auto& plan : experiment.nodes)
    if (plan.settings.program)
      throw Error{
          fmt::format("{}: node '{}' is a program of its own, which has no virtual time; "
                      "expected the wall clock (--clock wall)",
                      experiment.file.string(), plan.node)};
  if (!experiment.has_own_solver())
    throw Error{experiment.file.string() +
                ": no node is a solver, expected one to end a run in virtual time"};
  RunEnd result;
  if (options.host.empty())
    result = run_on_one_host(experiment, assembly, options);
  else
    result.trouble = run_on_several_hosts(experiment, assembly, options);
  for (auto& station : assembly.stations) {
    if (!options.host.empty() && station.plan.host != options.host) continue;
    try {
      station.adapter->deactivate();
    } catch (const Error& error) {
      if (result.trouble.empty())
        result.trouble = fmt::format("{}: {}", station.plan.node, error.what());
    }
  }
  return result;
}

}  // namespace rths::launch

// SPDX-License-Identifier: Apache-2.0
//
// A run in real time: one process per node on a ring in shared memory. Starts, watches and stops
// them together.
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <deque>
#include <limits>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/replicated/images.hpp>

#include "child_process.hpp"
#include "host_link.hpp"
#include "host_probe.hpp"
#include "interrupt.hpp"
#include "launcher_link.hpp"
#include "ownership.hpp"
#include "run_modes.hpp"

namespace rths::launch {
namespace {

constexpr Duration kScanPeriod = std::chrono::microseconds{50};

constexpr int kPriority = 65;  // between the host probe and the adapters

// No fault is due before the run begins.
constexpr replicated::Time kNever{std::numeric_limits<replicated::Time::rep>::max() / 2};

/// Carries the messages of a replicated ring in real time, in a thread of this process.
class CardCarrier {
 public:
  /// @param images  used by the thread alone until this object is destroyed
  explicit CardCarrier(replicated::Images& images) : images_{images}, thread_{[this] { run(); }} {}
  ~CardCarrier() {
    ends_.store(true);
    thread_.join();
  }
  CardCarrier(const CardCarrier&) = delete;
  CardCarrier& operator=(const CardCarrier&) = delete;

  /// Sets the common time zero of the run, from which the faults count.
  void begin(TimePoint epoch) { epoch_.store(epoch.count()); }

 private:
  void run() {
    static_cast<void>(make_realtime(kPriority));
    WallClock clock;
    const TimePoint start = clock.now();
    images_.begin(kNever);
    bool has_begun = false;
    while (!ends_.load(std::memory_order_relaxed)) {
      if (const auto epoch = epoch_.load(std::memory_order_relaxed); epoch != 0 && !has_begun) {
        has_begun = true;
        images_.begin(replicated::Time{TimePoint{epoch} - start});
      }
      images_.advance(replicated::Time{clock.now() - start});
      clock.sleep_until(clock.now() + kScanPeriod);
    }
  }

  replicated::Images& images_;
  std::atomic<bool> ends_{false};
  std::atomic<TimePoint::rep> epoch_{0};  ///< 0: not known yet
  std::thread thread_;                    ///< last, because it uses the members above
};

constexpr auto kReadyDeadline = std::chrono::seconds{20};
constexpr auto kHeadStart = std::chrono::milliseconds{50};  // between "go" and the first step
constexpr auto kHeadStartOfHosts = std::chrono::milliseconds{500};
constexpr auto kRestMargin = std::chrono::seconds{1};  // beyond the longest stop of a node
constexpr int kPollPeriod = 50;                        // [ms]
constexpr auto kLifePeriod = std::chrono::milliseconds{50};
constexpr double kProbeMargin = 10;  // [s] beyond the planned duration
// Beyond the planned duration: a foreign solver that counts its steps may say farewell first.
constexpr double kFarewellMargin = 1;  // [s]

// Some nodes are ready only after another program has connected.
Duration longest_start(const Experiment& experiment) {
  double longest = 0;
  for (const auto& plan : experiment.nodes)
    longest = std::max(longest, plan.settings.start_deadline);
  return kReadyDeadline + from_seconds(longest);
}

struct NodeProcess {
  std::string node;
  ChildProcess process;
  bool done = false;
};

class WallRun {
 public:
  /// @param link  to the other hosts of the test; null on one host
  WallRun(const Experiment& experiment, const Assembly& assembly, const RunOptions& options,
          HostLink* link)
      : experiment_{experiment}, options_{options}, link_{link} {
    for (const auto& station : assembly.stations)
      if (link == nullptr || station.plan.host == options.host)
        nodes_.push_back({station.plan.node, ChildProcess{arguments_for(station.plan.node)}});
  }

  /// Looks for words that another process than their owner stores.
  void watch_by(OwnershipWatch& ownership) { ownership_ = &ownership; }
  /// The thread that carries the messages of cards.
  void carry_by(CardCarrier& carrier) { carrier_ = &carrier; }

  void wait_until_ready() {
    const TimePoint deadline = clock_.now() + longest_start(experiment_);
    for (auto& node : nodes_) {
      std::optional<std::string> line;
      while (!(line = node.process.read_line()) && !node.process.ended() &&
             clock_.now() < deadline && !InterruptGuard::is_called_off()) {
        show_life();
        wait_for_output();
      }
      if (line == "ready" && !node.process.ended()) continue;
      if (InterruptGuard::is_called_off()) return;
      throw Error{fmt::format(
          "node '{}' did not become ready: it {}", node.node,
          node.process.ended() ? node.process.ending() : "sent no message before the deadline")};
    }
    if (link_ != nullptr) link_->wait_until_ready([this] { return has_lost_a_node(); });
  }

  RunEnd run() {
    if (InterruptGuard::is_called_off()) {
      result_.interrupted = true;
      return std::move(result_);
    }
    if (options_.started) options_.started();
    const auto agreed = agree_on_epoch();
    if (!agreed) return std::move(result_);
    const TimePoint epoch = *agreed;
    if (carrier_ != nullptr) carrier_->begin(epoch);
    for (auto& node : nodes_) node.process.send_line(fmt::format("go {}", epoch.count()));
    HostProbe probe{epoch, experiment_.time.duration * experiment_.time.rate * 2 + kProbeMargin};
    while (!all_ended()) {
      attend_to_nodes();
      if (!stopping_ && is_over(epoch)) stop("");
      if (!stopping_) look_for_end(epoch);
      if (!stopping_ && InterruptGuard::is_stop_requested()) {
        result_.stopped_early = experiment_.has_own_solver() || clock_.now() < end_of_test(epoch);
        stop("");
      }
      report_progress(epoch);
    }
    result_.interrupted = InterruptGuard::is_interrupted();
    result_.lateness = probe.finish();
    if (ownership_ != nullptr) result_.foreign_stores = ownership_->finish(epoch);
    return std::move(result_);
  }

 private:
  // Reads their messages, and stops them or kills those that do not stop in time.
  void attend_to_nodes() {
    show_life();
    wait_for_output();
    for (auto& node : nodes_) read_messages(node);
    if (InterruptGuard::is_interrupted() && !stopping_) stop("interrupted");
    if (link_ != nullptr && !stopping_) follow_other_hosts();
    if (stopping_ && clock_.now() > *stopping_ + longest_stop(experiment_) + kRestMargin)
      kill_remaining();
  }

  // A solver of this project ends the run itself.
  [[nodiscard]] bool is_over(TimePoint epoch) const {
    if (experiment_.has_own_solver()) return false;
    return clock_.now() > end_of_test(epoch) + from_seconds(kFarewellMargin);
  }
  // A solver of the user's own may never end the test.
  void look_for_end(TimePoint epoch) {
    const auto latest = experiment_.latest_end();
    const double now = to_seconds(clock_.now() - epoch);
    if (!latest || now <= *latest) return;
    result_.trouble = late_end(experiment_, now);
    stop(result_.trouble);
  }
  [[nodiscard]] TimePoint end_of_test(TimePoint epoch) const {
    return epoch +
           from_seconds(experiment_.time.rest + experiment_.time.duration * experiment_.time.rate);
  }

  // The leading host sets the common time zero. Empty if there is none: the result has the reason.
  std::optional<TimePoint> agree_on_epoch() {
    if (link_ == nullptr) return clock_.now() + kHeadStart;
    if (link_->is_leader()) {
      const TimePoint epoch = clock_.now() + kHeadStartOfHosts;
      link_->publish(HostState::Going, "", epoch);
      return epoch;
    }
    const TimePoint deadline = clock_.now() + kReadyDeadline;
    while (clock_.now() < deadline && !has_lost_a_node()) {
      if (const auto epoch = link_->epoch()) return epoch;
      if (const auto trouble = link_->find_trouble()) {
        result_.trouble = *trouble;
        return std::nullopt;
      }
    }
    result_.interrupted = InterruptGuard::is_called_off();
    result_.trouble = "the leading host did not start the test";
    return std::nullopt;
  }

  // Before the start: shows life to the nodes, which wait. @throws Error if one has ended
  bool has_lost_a_node() {
    show_life();
    wait_for_output();
    for (const auto& node : nodes_)
      if (node.process.ended())
        throw Error{fmt::format("node '{}' {} before the start", node.node, node.process.ending())};
    return InterruptGuard::is_called_off();
  }

  void follow_other_hosts() {
    if (const auto trouble = link_->find_trouble()) {
      if (result_.trouble.empty()) result_.trouble = *trouble;
      stop(*trouble);
    } else if (link_->is_stopped_early()) {
      result_.stopped_early = true;
      stop("");
    } else if (link_->is_test_over()) {
      stop("");
    }
  }

  [[nodiscard]] std::vector<std::string> arguments_for(const std::string& node) const {
    std::vector<std::string> arguments{
        "node",        experiment_.file.string(),  "--node", node, "--ring", options_.ring,
        "--recording", options_.recording.string()};
    for (const auto& [key, value] : options_.overrides) {
      arguments.emplace_back("--set");
      arguments.push_back(fmt::format("{}={}", key, value));
    }
    return arguments;
  }

  // The nodes come to rest without these lines.
  void show_life() {
    if (clock_.now() < shown_ + kLifePeriod) return;
    shown_ = clock_.now();
    for (auto& node : nodes_) node.process.send_line(kAlive);
  }

  void wait_for_output() {
    std::vector<pollfd> descriptors;
    for (const auto& node : nodes_)
      if (!node.process.ended()) descriptors.push_back({node.process.output(), POLLIN, 0});
    poll(descriptors.data(), descriptors.size(), kPollPeriod);
  }

  [[nodiscard]] bool all_ended() const {
    return std::all_of(nodes_.begin(), nodes_.end(),
                       [](const auto& node) { return node.process.ended(); });
  }

  void read_messages(NodeProcess& node) {
    if (node.process.ended()) return;
    while (const auto line = node.process.read_line()) {
      if (*line == "done") {
        node.done = true;
        if (!stopping_) stop("");
      } else if (line->rfind("fault ", 0) == 0) {
        fail(node, ": " + line->substr(6));
      } else if (line->rfind("note ", 0) == 0) {
        result_.privileges.push_back(node.node + ": " + line->substr(5));
      } else if (line->rfind(kTimesLine, 0) == 0) {
        read_times(line->substr(std::string_view{kTimesLine}.size()), result_.times[node.node]);
      }
    }
    // A node stopped after a fault also exits with an error; the reason is already known.
    const bool regular = node.done && (stopped_for_a_reason_ || node.process.succeeded());
    if (node.process.ended() && !regular)
      fail(node, fmt::format(" (process {}) {}", node.process.pid(), node.process.ending()));
  }

  void fail(const NodeProcess& node, const std::string& reason) {
    const std::string trouble = node.node + reason;
    if (result_.trouble.empty()) result_.trouble = trouble;
    if (!stopping_) stop(trouble);
  }

  // An empty reason is the regular end of a run.
  void stop(const std::string& reason) {
    stopping_ = clock_.now();
    stopped_for_a_reason_ = !reason.empty();
    for (auto& node : nodes_) node.process.send_line(reason.empty() ? "stop" : "stop " + reason);
    if (link_ != nullptr)
      link_->publish(result_.stopped_early ? HostState::StoppedEarly : HostState::Stopping, reason);
  }

  void kill_remaining() {
    for (auto& node : nodes_)
      if (!node.process.ended()) {
        ::kill(node.process.pid(), SIGKILL);
        if (result_.trouble.empty())
          result_.trouble = fmt::format("{} did not come to rest and was killed", node.node);
      }
  }

  void report_progress(TimePoint epoch) {
    if (!options_.progress) return;
    options_.progress(
        {to_seconds(clock_.now() - epoch) / experiment_.time.rate, experiment_.time.duration});
  }

  const Experiment& experiment_;
  const RunOptions& options_;
  HostLink* link_;
  CardCarrier* carrier_ = nullptr;
  OwnershipWatch* ownership_ = nullptr;
  WallClock clock_;
  std::deque<NodeProcess> nodes_;
  std::optional<TimePoint> stopping_;
  TimePoint shown_{0};
  bool stopped_for_a_reason_ = false;
  RunEnd result_;
};

// Tells the other hosts how the test ended here.
RunEnd run_with_other_hosts(const Experiment& experiment, const Assembly& assembly,
                            const RunOptions& options, HostLink& link, OwnershipWatch& ownership) {
  const Duration farewell = longest_stop(experiment) + kRestMargin;
  RunEnd result;
  try {
    WallRun run{experiment, assembly, options, &link};
    run.watch_by(ownership);
    run.wait_until_ready();
    result = run.run();
  } catch (const Error& error) {
    link.publish(HostState::Failed, error.what());
    link.wait_until_ended(farewell);
    throw;
  }
  const std::string reason = result.interrupted ? "interrupted" : result.trouble;
  link.publish(reason.empty() ? HostState::Completed : HostState::Failed, reason);
  link.wait_until_ended(farewell);
  return result;
}

// On a ring of cards: each node has an image of its own.
RunEnd run_on_images(const Experiment& experiment, const Assembly& assembly,
                     const RunOptions& options) {
  auto images = replicated::Images::create(options.ring, assembly.map, *assembly.cards);
  const RunCleaning cleaning{options};
  RunEnd result;
  {
    CardCarrier carrier{images};
    WallRun run{experiment, assembly, options, nullptr};
    run.carry_by(carrier);
    run.wait_until_ready();
    result = run.run();
  }
  add_faults(images.events(), result);
  return result;
}

}  // namespace

RunEnd run_in_wall_time(const Experiment& experiment, const Assembly& assembly,
                        const RunOptions& options) {
  const InterruptGuard guard;
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  if (assembly.cards) return run_on_images(experiment, assembly, options);
  broker::Ring ring = broker::Ring::create(options.ring, assembly.map);
  const RunCleaning cleaning{options};
  OwnershipWatch ownership{ring};
  if (options.host.empty()) {
    WallRun run{experiment, assembly, options, nullptr};
    run.watch_by(ownership);
    run.wait_until_ready();
    return run.run();
  }
  HostLink link{ring, experiment, options};
  return run_with_other_hosts(experiment, assembly, options, link, ownership);
}

}  // namespace rths::launch

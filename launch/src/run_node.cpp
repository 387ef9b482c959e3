// SPDX-License-Identifier: Apache-2.0
//
// A node of a run in its own process. The real-time thread runs the adapter. The main thread reads
// messages of the launcher, watches the peers, and stops the real-time thread.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

#include "launcher_link.hpp"
#include "peer_watch.hpp"
#include "run_modes.hpp"

namespace rths::launch {
namespace {

/// The real-time thread and its result.
class LoopThread {
 public:
  LoopThread(adapters::AdapterRunner& runner, TimePoint epoch, const NodePlan& plan)
      : thread_{[this, &runner, epoch, &plan] {
          missing_ = make_realtime(plan.settings.priority);
          WallClock clock;
          end_ = adapters::run_loop(runner, clock, epoch, stopping_);
          finished_.store(true, std::memory_order_release);
        }} {}
  ~LoopThread() {
    stop();
    if (thread_.joinable()) thread_.join();
  }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  void stop() { stopping_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool finished() const { return finished_.load(std::memory_order_acquire); }
  [[nodiscard]] const adapters::LoopEnd& end() const { return end_; }
  /// Missing privileges, as text.
  [[nodiscard]] const std::string& missing() const { return missing_; }

 private:
  std::atomic<bool> stopping_{false};
  std::atomic<bool> finished_{false};
  adapters::LoopEnd end_;
  std::string missing_;
  std::thread thread_;  ///< last, because it uses the members above
};

/// Why a node stopped.
struct Reason {
  std::string text;       ///< empty: the regular end of the run
  bool is_known = false;  ///< the launcher gave the reason
};

// A stop request of the launcher, the loss of the launcher, or a peer in trouble.
std::optional<Reason> reason_to_stop(const std::optional<std::string>& line, LauncherLink& launcher,
                                     PeerWatch& peers, TimePoint now) {
  if (line && line->rfind("stop", 0) == 0)
    return Reason{line->size() > 5 ? line->substr(5) : "", true};
  if (const auto trouble = launcher.find_trouble(now)) return Reason{*trouble, false};
  if (const auto trouble = peers.find_trouble(now)) return Reason{*trouble, false};
  return std::nullopt;
}

// Waits until the loop ends; stops it if there is a reason, which may be its own.
Reason watch(LoopThread& loop, const adapters::AdapterRunner& runner, LauncherLink& launcher,
             PeerWatch& peers, Duration longest_stop) {
  const WallClock clock;
  std::optional<Reason> reason;
  TimePoint give_up{};
  while (!loop.finished()) {
    const auto line = launcher.receive_line(kLookPeriod);
    if (!reason) {
      reason = reason_to_stop(line, launcher, peers, clock.now());
      if (const std::string request = runner.stop_request(); !reason && !request.empty()) {
        LauncherLink::send_line("fault " + request);
        reason = Reason{request, false};
      }
      give_up = clock.now() + longest_stop;
      if (reason) loop.stop();
    } else if (clock.now() > give_up) {
      write_message("the control loop did not stop in time; ending the process\n");
      std::_Exit(2);
    }
  }
  // A loop that ends because the ring is lost may do so between two looks.
  if (!reason && peers.is_ring_lost()) reason = reason_to_stop({}, launcher, peers, clock.now());
  return reason.value_or(Reason{"", true});
}

// Reports the end of the node to the launcher and on standard error.
int conclude(const LoopThread& loop, const adapters::AdapterRunner& runner, const std::string& node,
             const Reason& reason, const experiment::Retreat& retreat) {
  const double time = to_seconds(loop.end().time);
  if (!loop.missing().empty()) LauncherLink::send_line("note " + loop.missing());
  const bool came_to_rest = reason.text == runner.message();  // it asked for the end itself
  if (loop.end().status == Status::Fault && !came_to_rest) {
    const auto fault = fmt::format("{} at {:.3f} s", runner.message(), time);
    LauncherLink::send_line("fault " + fault);
    write_message(fmt::format("{}: {}\n", node, fault));
    return 2;
  }
  LauncherLink::send_line(reason.is_known ? "done" : "fault " + reason.text);
  if (reason.text.empty()) return 0;
  write_message(
      fmt::format("{}: {}: held {:.1f} s, ramped to rest in {:.1f} s, ended at {:.3f} s\n", node,
                  reason.text, retreat.hold, retreat.ramp, time));
  return 2;
}

// A fault during deactivation is a fault of the node.
int deactivate(adapters::Adapter& adapter, const std::string& node, int code) {
  try {
    adapter.deactivate();
    return code;
  } catch (const Error& error) {
    LauncherLink::send_line(fmt::format("fault {}", error.what()));
    write_message(fmt::format("{}: {}\n", node, error.what()));
    return 2;
  }
}

// Signals of a terminal reach all processes of a run. The launcher handles them and brings all
// nodes to rest. If it ends or stops, the nodes come to rest by themselves.
void leave_signals_to_the_launcher() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGTTOU})
    std::signal(signal, SIG_IGN);
}

}  // namespace

int run_node(const Experiment& experiment, const std::string& node, const std::string& ring_name,
             const std::filesystem::path& recording, const std::string& version) {
  leave_signals_to_the_launcher();
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  const NodePlan* plan = experiment.node(node);
  const bool records = plan != nullptr && plan->settings.role == experiment::Role::Recorder;
  Assembly assembly = assemble(experiment, ClockKind::Wall,
                               {recording, describe_run(experiment, ClockKind::Wall, version),
                                records ? experiment.texts() : recording::NamedTexts{}});
  const auto station = std::find_if(assembly.stations.begin(), assembly.stations.end(),
                                    [&](const Station& s) { return s.plan.node == node; });
  if (station == assembly.stations.end())
    throw Error{fmt::format("experiment '{}' has no node '{}'", experiment.name, node)};
  broker::Ring ring = broker::Ring::attach(ring_of(experiment, ring_name, node));
  if (station->plan.settings.program)
    return run_foreign_node(experiment, station->plan, ring, {ring_name, recording});
  adapters::AdapterRunner runner{*station->adapter, ring, node, assembly.map.hash(),
                                 station->plan.schedule};
  await_others(experiment, station->plan, runner, ring);
  LauncherLink launcher;
  {
    const SetupGuard guard{launcher, node};
    station->adapter->activate();
  }
  if (station->plan.settings.keeps_times) runner.keep_times(steps_of(experiment, station->plan));
  LauncherLink::send_line("ready");
  const auto epoch = launcher.wait_for_go();
  if (!epoch) {
    write_message(fmt::format("{}: received no start message\n", node));
    return deactivate(*station->adapter, node, 2);
  }
  int code = 0;
  {
    LoopThread loop{runner, *epoch, station->plan};
    PeerWatch peers{runner.node(), assembly.map, experiment, node};
    const Reason reason = watch(loop, runner, launcher, peers, longest_stop(experiment));
    code = conclude(loop, runner, node, reason, experiment.stop.retreat);
  }
  if (code == 0) send_times(runner.times());
  code = deactivate(*station->adapter, node, code);
  // After a fault, exits without leaving the ring, so that peers detect it even without the
  // launcher.
  if (code != 0) {
    assembly.stations.clear();  // adapters remove their files
    std::_Exit(code);
  }
  return code;
}

}  // namespace rths::launch

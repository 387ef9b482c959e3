// SPDX-License-Identifier: Apache-2.0
//
// A node of a run in its own process. The real-time thread runs the adapter. The main thread reads
// messages of the launcher, watches the peers, and stops the real-time thread.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "realtime_thread.hpp"
#include "run_modes.hpp"

namespace rths::launch {
namespace {

constexpr int kLauncherPollPeriod = 20;                    // [ms]
constexpr auto kLongestGo = std::chrono::seconds{30};      // from ready to go
constexpr auto kSilence = std::chrono::milliseconds{500};  // of a running peer

// Exchanges lines with the launcher. The launcher has vanished when its end of the pipe closes.
class Launcher {
 public:
  // Several lines can arrive at once: buffered lines come first, before the end of the pipe.
  std::optional<std::string> receive_line(int timeout_ms) {
    if (auto line = take_line()) return line;
    pollfd descriptor{STDIN_FILENO, POLLIN, 0};
    if (poll(&descriptor, 1, timeout_ms) <= 0) return std::nullopt;
    std::array<char, 512> chunk{};
    const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
    vanished_ = count <= 0;
    if (!vanished_) received_.append(chunk.data(), static_cast<std::size_t>(count));
    return take_line();
  }
  [[nodiscard]] bool vanished() const { return vanished_; }
  static void send_line(const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }

 private:
  std::optional<std::string> take_line() {
    const auto end = received_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    return line;
  }

  std::string received_;
  bool vanished_ = false;
};

// Detects vanished and silent peers. A peer has vanished when the kernel reports the end of its
// process. It is silent when its heartbeats stop while those of this node continue.
class PeerWatch {
 public:
  PeerWatch(adapters::AdapterRunner& runner, const memmap::Map& map, const Experiment& experiment,
            const std::string& own_name)
      : node_{runner.node()}, own_{map.node(own_name)} {
    // Only nodes of the experiment count; others may join to observe or to tune.
    for (const auto& plan : experiment.nodes)
      if (std::count(runner.peers().begin(), runner.peers().end(), plan.node) > 0)
        peers_.push_back({plan.node, map.node(plan.node), 0, {}, 0});
  }

  std::optional<std::string> find_trouble(TimePoint now) {
    const std::uint64_t own_beats = node_.beats_of(own_);
    for (auto& peer : peers_) {
      const auto presence = node_.presence_of(peer.id);
      if (presence.state == broker::Presence::State::Vanished)
        return fmt::format("{} (process {}) vanished", peer.name, presence.pid);
      if (presence.state == broker::Presence::State::Absent) continue;  // it left in order
      const std::uint64_t beats = node_.beats_of(peer.id);
      if (beats != peer.beats || peer.since == TimePoint{}) {
        peer.beats = beats;
        peer.since = now;
        peer.own_beats = own_beats;
      }
      // A stopped host also stops this node, so silence is counted in its own steps.
      if (now - peer.since > kSilence && own_beats > peer.own_beats + kStepsOfSilence)
        return fmt::format("{} (process {}) is silent", peer.name, presence.pid);
    }
    return std::nullopt;
  }

 private:
  static constexpr std::uint64_t kStepsOfSilence = 100;
  struct Peer {
    std::string name;
    NodeId id;
    std::uint64_t beats;
    TimePoint since;
    std::uint64_t own_beats;
  };
  const broker::Node& node_;
  NodeId own_;
  std::vector<Peer> peers_;
};

std::optional<TimePoint> wait_for_go(Launcher& launcher) {
  WallClock clock;
  const TimePoint deadline = clock.now() + kLongestGo;
  while (clock.now() < deadline && !launcher.vanished()) {
    const auto line = launcher.receive_line(kLauncherPollPeriod);
    if (!line) continue;
    if (line->rfind("go ", 0) == 0) return TimePoint{std::stoll(line->substr(3))};
    return std::nullopt;
  }
  return std::nullopt;
}

/// The real-time thread and its result.
class LoopThread {
 public:
  LoopThread(adapters::AdapterRunner& runner, TimePoint epoch, const NodePlan& plan)
      : thread_{[this, &runner, epoch, &plan] {
          missing_ = make_realtime(priority_of(plan.adapter));
          WallClock clock;
          end_ = adapters::run_loop(runner, clock, epoch, plan.schedule, stopping_);
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

// A stop request of the launcher, the end of the launcher, or a peer in trouble.
std::optional<Reason> reason_to_stop(const std::optional<std::string>& line,
                                     const Launcher& launcher, PeerWatch& peers) {
  if (line && line->rfind("stop", 0) == 0)
    return Reason{line->size() > 5 ? line->substr(5) : "", true};
  if (launcher.vanished()) return Reason{"the launcher vanished", false};
  if (const auto trouble = peers.find_trouble(WallClock{}.now())) return Reason{*trouble, false};
  return std::nullopt;
}

// Waits until the loop ends; stops it if there is a reason.
Reason watch(LoopThread& loop, Launcher& launcher, PeerWatch& peers, Duration longest_stop) {
  const WallClock clock;
  std::optional<Reason> reason;
  TimePoint give_up{};
  while (!loop.finished()) {
    const auto line = launcher.receive_line(kLauncherPollPeriod);
    if (!reason) {
      reason = reason_to_stop(line, launcher, peers);
      give_up = clock.now() + longest_stop;
      if (reason) loop.stop();
    } else if (clock.now() > give_up) {
      fmt::print(stderr, "the control loop did not stop in time; ending the process\n");
      std::_Exit(2);
    }
    // Polling a closed pipe returns at once; avoid a busy loop.
    if (launcher.vanished())
      std::this_thread::sleep_for(std::chrono::milliseconds{kLauncherPollPeriod});
  }
  return reason.value_or(Reason{"", true});
}

// Reports the end of the node to the launcher and on standard error.
int conclude(const LoopThread& loop, const adapters::AdapterRunner& runner, const std::string& node,
             const Reason& reason, const adapters::Retreat& retreat) {
  const double time = to_seconds(loop.end().time);
  if (!loop.missing().empty()) Launcher::send_line("note " + loop.missing());
  if (loop.end().status == Status::Fault) {
    Launcher::send_line(fmt::format("fault {}", runner.message()));
    fmt::print(stderr, "{}: {} at {:.3f} s\n", node, runner.message(), time);
    return 2;
  }
  Launcher::send_line(reason.is_known ? "done" : "fault " + reason.text);
  if (reason.text.empty()) return 0;
  fmt::print(stderr, "{}: {}: held {:.1f} s, ramped to rest in {:.1f} s, ended at {:.3f} s\n", node,
             reason.text, retreat.hold, retreat.ramp, time);
  return 2;
}

// A fault during deactivation is a fault of the node.
int deactivate(adapters::Adapter& adapter, const std::string& node, int code) {
  try {
    adapter.deactivate();
    return code;
  } catch (const Error& error) {
    Launcher::send_line(fmt::format("fault {}", error.what()));
    fmt::print(stderr, "{}: {}\n", node, error.what());
    return 2;
  }
}

// Signals of a terminal reach all processes of a run. The launcher handles them and brings all
// nodes to rest; if it cannot, its pipe closes.
void leave_signals_to_the_launcher() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) std::signal(signal, SIG_IGN);
}

}  // namespace

int run_node(const Experiment& experiment, const std::string& node, const std::string& ring_name,
             const std::filesystem::path& recording, const std::string& version) {
  leave_signals_to_the_launcher();
  Assembly assembly = assemble(experiment, ClockKind::Wall,
                               {recording, describe_run(experiment, ClockKind::Wall, version)});
  const auto station = std::find_if(assembly.stations.begin(), assembly.stations.end(),
                                    [&](const Station& s) { return s.plan.node == node; });
  if (station == assembly.stations.end())
    throw Error{fmt::format("experiment '{}' has no node '{}'", experiment.name, node)};
  broker::Ring ring = broker::Ring::attach(ring_name);
  adapters::AdapterRunner runner{*station->adapter, ring, node, assembly.map.hash(),
                                 station->plan.schedule.period};
  station->adapter->activate();
  Launcher launcher;
  Launcher::send_line("ready");
  const auto epoch = wait_for_go(launcher);
  if (!epoch) {
    fmt::print(stderr, "{}: received no start message\n", node);
    return deactivate(*station->adapter, node, 2);
  }
  int code = 0;
  {
    LoopThread loop{runner, *epoch, station->plan};
    PeerWatch peers{runner, assembly.map, experiment, node};
    const Reason reason = watch(loop, launcher, peers, longest_stop(experiment));
    code = conclude(loop, runner, node, reason, experiment.retreat);
  }
  code = deactivate(*station->adapter, node, code);
  // After a fault, exits without leaving the ring, so that peers detect it even without the
  // launcher.
  if (code != 0) std::_Exit(code);
  return code;
}

}  // namespace rths::launch

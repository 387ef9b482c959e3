// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cstdio>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <rths/adapters/child_program.hpp>
#include <rths/adapters/opf_layout.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/user_program.hpp>

#include "launcher_link.hpp"
#include "peer_watch.hpp"
#include "run_modes.hpp"

namespace rths::launch {
namespace {

using broker::Presence;

constexpr Duration kSamplePeriod = std::chrono::milliseconds{1};
// A program that leaves the ring exits soon. One that was asked to end is killed after this time.
constexpr Duration kLongestExit = std::chrono::milliseconds{500};

/// Counts the signs of life of a node's program: its heartbeats, and new values in its words. A
/// program of the vendor's API stores through a pointer and has no heartbeat.
class SignsOfLife {
 public:
  /// @param observer  used by the thread of this object alone, except for its presences
  SignsOfLife(const broker::Node& observer, const memmap::Map& map, const std::string& node)
      : observer_{observer}, node_{map.node(node)} {
    for (const auto& entry : map.signals())
      if (entry.partition->node == node) words_.push_back(entry.signal->offset);
    thread_ = std::thread{[this] { run(); }};
  }
  ~SignsOfLife() {
    done_.store(true, std::memory_order_relaxed);
    thread_.join();
  }
  SignsOfLife(const SignsOfLife&) = delete;
  SignsOfLife& operator=(const SignsOfLife&) = delete;

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }

 private:
  // A sum that changes with any single word (FNV-1a).
  [[nodiscard]] std::uint64_t sample() const {
    constexpr std::uint64_t kOffset = 0xCBF29CE484222325, kPrime = 0x100000001B3;
    std::uint64_t sum = kOffset;
    const auto add = [&](std::uint64_t value) { sum = (sum ^ value) * kPrime; };
    add(observer_.beats_of(node_));
    for (const auto word : words_) add(observer_.read(word));
    return sum;
  }
  void run() {
    std::uint64_t last = sample();
    while (!done_.load(std::memory_order_relaxed)) {
      std::this_thread::sleep_for(kSamplePeriod);
      const std::uint64_t now = sample();
      if (now != last) count_.fetch_add(1, std::memory_order_relaxed);
      last = now;
    }
  }

  const broker::Node& observer_;
  NodeId node_;
  std::vector<LongwordOffset> words_;
  std::atomic<std::uint64_t> count_{0};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

/// Why the watch over a program ended.
struct Ending {
  std::string reason;     ///< empty: the regular end of the run
  bool is_known = false;  ///< the launcher gave the reason, or there is none
  bool has_left = false;  ///< the program itself has ended or left the ring
};

/// A foreign node and its program.
class ForeignNode {
 public:
  ForeignNode(const Experiment& experiment, const NodePlan& plan, broker::Ring& ring,
              const RunPlace& place)
      : experiment_{experiment},
        plan_{plan},
        ring_{ring},
        observer_{ring.observe()},
        id_{ring.map().node(plan.node)},
        signs_{observer_, ring.map(), plan.node} {
    if (plan.settings.program->command.empty())
      ask_for_program(place);
    else
      start_program(place);
  }

  /// @throws Error if the program ends, or the deadline passes
  void wait_until_joined() {
    const WallClock clock;
    const TimePoint deadline = clock.now() + from_seconds(plan_.settings.program->connect_deadline);
    while (presence().state != Presence::State::Alive) {
      if (program_ && program_->has_ended())
        throw Error{fmt::format("{} ended before it joined the ring as node '{}'{}", name_,
                                plan_.node, with_failure())};
      if (clock.now() > deadline)
        throw Error{
            fmt::format("no program joined the ring as node '{}' within {:g} s "
                        "(connect_deadline_s){}",
                        plan_.node, plan_.settings.program->connect_deadline, hint_)};
      std::this_thread::sleep_for(kLookPeriod);
    }
    process_ = presence().pid;
  }

  Ending watch(LauncherLink& launcher) {
    PeerWatch peers{observer_, ring_.map(), experiment_, plan_.node};
    const WallClock clock;
    began_ = clock.now();
    for (;;) {
      const auto line = launcher.receive_line(kLookPeriod);
      if (line && line->rfind("stop", 0) == 0)
        return {line->size() > 5 ? line->substr(5) : "", true, false};
      const TimePoint now = clock.now();
      if (const auto trouble = launcher.find_trouble(now)) return {*trouble, false, false};
      if (auto ending = look_at_program()) return *ending;
      if (const auto trouble = peers.find_trouble(now)) return {*trouble, false, false};
      if (const auto trouble = find_silence(signs_.count(), now)) return {*trouble, false, false};
    }
  }

  /// Waits while the others come to rest, then ends the program. Its exit code no longer matters.
  void release() {
    const auto rest = from_seconds(experiment_.stop.retreat.hold + experiment_.stop.retreat.ramp);
    if (!program_) return wait_until_left(rest);
    if (program_->wait(rest)) return;
    program_->ask_to_end();
    program_->wait(kLongestExit);
  }

 private:
  [[nodiscard]] Presence presence() const { return observer_.presence_of(id_); }

  void start_program(const RunPlace& place) {
    const experiment::UserProgram& program = *plan_.settings.program;
    // Of a program that joins by our interface. Cards find their image themselves.
    const std::string own_ring = ring_of(experiment_, place.ring, plan_.node);
    const auto motion = experiment::file_beside(place.recording, plan_.node, ".motion.csv");
    adapters::ProgramStart start;
    for (auto argument : program.command) {
      if (experiment::fill_in(argument, experiment_, motion))
        std::ofstream{motion} << experiment::motion_text(experiment_.earthquake.motion);
      replace_all(argument, experiment::kRingPlaceholder, own_ring);
      replace_all(argument, experiment::kNodePlaceholder, plan_.node);
      start.command.push_back(std::move(argument));
    }
    name_ = std::filesystem::path{start.command[0]}.filename().string();
    hint_ = fmt::format("; {} runs: does it open a card, or join as '{}'?", name_, plan_.node);
    start.name = name_;
    start.folder = program.folder;
    start.log =
        std::filesystem::absolute(experiment::file_beside(place.recording, plan_.node, ".log"));
    for (const char* api : {"RTHS_", "RTHS_SCRAMNET_", "RTHS_SCGT_"}) {
      start.environment.emplace_back(std::string{api} + "RING",
                                     api == std::string{"RTHS_"} ? own_ring : place.ring);
      start.environment.emplace_back(std::string{api} + "NODE", plan_.node);
    }
    program_.emplace(start);
  }

  void ask_for_program(const RunPlace& place) {
    name_ = "its program";
    hint_ = fmt::format(
        ": start it with RTHS_SCRAMNET_RING={0} RTHS_SCRAMNET_NODE={1} (GT cards: RTHS_SCGT_RING, "
        "RTHS_SCGT_NODE), or join ring '{2}' as node '{1}'",
        place.ring, plan_.node, ring_of(experiment_, place.ring, plan_.node));
    write_message(fmt::format("{}: waits {:g} s for its program{}\n", plan_.node,
                              plan_.settings.program->connect_deadline, hint_));
  }

  [[nodiscard]] std::string with_failure() const {
    const auto failure = program_->failure();
    return failure ? ": " + *failure : "";
  }

  // Its end, or its departure from the ring: a farewell if it is in order.
  [[nodiscard]] std::optional<Ending> look_at_program() {
    const auto state = presence().state;
    if (state == Presence::State::Alive) return std::nullopt;
    if (program_ && program_->wait(kLongestExit))
      if (const auto failure = program_->failure()) return Ending{*failure, false, true};
    if (state == Presence::State::Absent) return Ending{"", true, true};
    return Ending{fmt::format("{} (process {}) vanished", name_, process_), false, true};
  }

  // Until its first sign, a program may wait for its user.
  [[nodiscard]] std::optional<std::string> find_silence(std::uint64_t signs, TimePoint now) {
    if (signs == 0) {
      if (now - began_ < from_seconds(plan_.settings.program->connect_deadline))
        return std::nullopt;
      return fmt::format("{} (process {}) wrote no word within {:g} s (connect_deadline_s){}",
                         name_, process_, plan_.settings.program->connect_deadline, missed_flag());
    }
    const double longest = plan_.settings.program->longest_silence * experiment_.time.rate;
    if (silence_.look(now, signs) <= from_seconds(longest)) return std::nullopt;
    return fmt::format(
        "{} (process {}) is silent: no new value in its words for {:g} s (silence_s){}", name_,
        process_, longest, missed_flag());
  }

  // OpenFresco locates the flags by counting the signals of its control points.
  [[nodiscard]] std::string missed_flag() const {
    for (const char* flag : {"opf.newTarget", "daq.switchPC", "daq.atTarget"})
      if (!ring_.map().find_signal(flag)) return "";
    const bool has_target = word("opf.newTarget") == 1;
    const char* const flag = has_target ? "daq.switchPC" : "daq.atTarget";
    if (word(flag) != 1) return "";
    const auto layout = adapters::opf_layout(ring_.map());
    return fmt::format(
        "; {} is 1 at word {} since: a program that waits for it looks at another word, expected "
        "control points of {} signals to the controller and {} back",
        flag, offset_of(flag).value(), layout.commands.size(), layout.feedbacks.size());
  }
  [[nodiscard]] LongwordOffset offset_of(const char* signal) const {
    return ring_.map().entry(ring_.map().signal(signal)).signal->offset;
  }
  [[nodiscard]] std::uint32_t word(const char* signal) const {
    return observer_.read(offset_of(signal));
  }

  void wait_until_left(Duration longest) const {
    const WallClock clock;
    for (const TimePoint deadline = clock.now() + longest; clock.now() < deadline;) {
      if (presence().state != Presence::State::Alive) return;
      std::this_thread::sleep_for(kLookPeriod);
    }
    write_message(
        fmt::format("{}: process {} is still on the ring of the run, which has ended; end it\n",
                    plan_.node, process_));
  }

  const Experiment& experiment_;
  const NodePlan& plan_;
  broker::Ring& ring_;
  broker::Node observer_;
  NodeId id_;
  SignsOfLife signs_;  // from before the program: its first words count
  std::string name_, hint_;
  std::optional<adapters::ChildProgram> program_;
  int process_ = 0;
  TimePoint began_{};
  Silence silence_;
};

}  // namespace

int run_foreign_node(const Experiment& experiment, const NodePlan& plan, broker::Ring& ring,
                     const RunPlace& place) {
  LauncherLink launcher;
  ForeignNode node{experiment, plan, ring, place};
  {
    const SetupGuard guard{launcher, plan.node};
    node.wait_until_joined();
  }
  LauncherLink::send_line("ready");
  if (!launcher.wait_for_go()) {
    write_message(fmt::format("{}: received no start message\n", plan.node));
    return 2;
  }
  const Ending ending = node.watch(launcher);
  // The others stop at once; the program is ended when they are at rest.
  if (!ending.is_known) LauncherLink::send_line("fault " + ending.reason);
  if (!ending.has_left) node.release();
  if (ending.is_known) LauncherLink::send_line("done");
  if (ending.reason.empty()) return 0;
  write_message(fmt::format("{}: {}\n", plan.node, ending.reason));
  return 2;
}

}  // namespace rths::launch

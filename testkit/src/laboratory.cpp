// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/laboratory.hpp>

#include <unistd.h>

#include <atomic>
#include <charconv>
#include <csignal>
#include <map>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/adapters/child_program.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>

#include "link.hpp"
#include "recorder.hpp"

namespace rths::testkit {
namespace {

constexpr double kEventually = 5;                     // [s]
constexpr double kLongestTime = 1e6;                  // [s]
constexpr Duration kGrace = std::chrono::seconds{2};  // of a program that was asked to end
constexpr Duration kProgramLook = std::chrono::milliseconds{20};        // at the programs
constexpr Duration kLastLooks = std::chrono::milliseconds{5};           // at stores
constexpr Duration kLongestJudgement = std::chrono::milliseconds{200};  // of a store
constexpr Duration kStartLook = std::chrono::milliseconds{2};
constexpr const char* kPrefix = "test_";
constexpr std::size_t kMostLogBytes = 100 << 20;

Duration duration_of(const std::string& name, double seconds) {
  if (!(seconds >= 0 && seconds <= kLongestTime))
    throw Error{fmt::format("{} is {} s, expected 0 to {} s", name, seconds, kLongestTime)};
  return from_seconds(seconds);
}

std::string new_name() {
  static std::atomic<unsigned> count{0};
  return fmt::format("{}{}_{}_{:06x}", kPrefix, getpid(), count.fetch_add(1),
                     std::random_device{}() & 0xFFFFFFU);
}

// Process id in the name of a ring of a test; 0: of no test.
int process_of(const std::string& name) {
  const std::string prefix{kPrefix};
  if (!name.starts_with(prefix)) return 0;
  int process = 0;
  const char* const begin = name.data() + prefix.size();
  const auto [end, error] = std::from_chars(begin, name.data() + name.size(), process);
  return error == std::errc{} && *end == '_' ? process : 0;
}

// A test that was killed could not remove its rings.
void remove_rings_of_killed_tests() {
  for (const auto& report : broker::list_rings()) {
    const int process = process_of(report.name);
    if (process > 0 && report.usable && !report.in_use() && ::kill(process, 0) != 0 &&
        errno == ESRCH)
      broker::remove_unused_ring(report.name);
  }
}

adapters::ProgramStart start_of(const Program& program, const std::string& name,
                                const std::string& ring) {
  adapters::ProgramStart start;
  start.name = fmt::format("program '{}'", name);
  for (auto argument : program.command) {
    replace_all(argument, "{ring}", ring);
    replace_all(argument, "{node}", program.node);
    start.command.push_back(std::move(argument));
  }
  if (!program.folder.empty()) start.folder = program.folder;
  for (const char* prefix : {"RTHS_", "RTHS_SCRAMNET_", "RTHS_SCGT_"}) {
    start.environment.emplace_back(fmt::format("{}RING", prefix), ring);
    if (!program.node.empty())
      start.environment.emplace_back(fmt::format("{}NODE", prefix), program.node);
  }
  start.is_favoured = false;
  return start;
}

}  // namespace

struct Laboratory::State {
  struct Started {
    std::unique_ptr<adapters::ChildProgram> process;
    bool is_killed = false;
  };
  std::filesystem::path folder;
  std::string name = new_name();
  TimePoint deadline;
  std::shared_ptr<SignalRing> ring;
  std::unique_ptr<SignalNode> observer;
  std::optional<WriteRecorder> recorder;
  std::map<std::string, std::unique_ptr<Link>> links;  ///< by node
  std::map<std::string, Started> programs;             ///< by name

  Started& program(const std::string& wanted) {
    const auto found = programs.find(wanted);
    if (found != programs.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [known, started] : programs) names.push_back(known);
    throw Error{fmt::format("there is no program '{}', expected one of: {}", wanted,
                            fmt::join(names, ", "))};
  }

  Link& link(const std::string& node) {
    const auto found = links.find(node);
    if (found == links.end())
      throw Error{fmt::format(
          "the program of node '{}' is not linked, so its messages cannot be changed", node)};
    return *found->second;
  }

  Link& link_of(const memmap::SignalEntry& entry) { return link(entry.partition->node); }
  /// Calls `changed` with each value, first the present one, until it returns true or the time is
  /// over. @returns the last value
  template <class Changed>

  double follow(double seconds, const std::string& signal, Changed changed) {
    const WallClock clock;
    const auto follower = ring->follow({signal});
    const TimePoint latest = std::min(deadline, clock.now() + duration_of("the time", seconds));
    double value = observer->read(signal);
    bool is_over = changed(value);
    while (!is_over) {
      broker::Write write;
      const Status status = follower->wait(std::min(latest, clock.now() + kProgramLook), write);
      if (status == Status::Late) {
        if (clock.now() >= latest) break;
        check_programs();
        continue;
      }
      if (status == Status::LimitExceeded)
        throw NotMet{
            fmt::format("{}: writes were lost: the test was more than a journal behind", signal)};
      value = follower->change_of(write).values.front().second;
      is_over = changed(value);
    }
    return value;
  }

  void wait_for_node(const Program& wanted, const std::string& program_name) {
    WallClock clock;
    const TimePoint latest = std::min(deadline, clock.now() + from_seconds(wanted.ready_s));
    Started& started = programs.at(program_name);
    while (observer->presence_of(wanted.node) != "alive") {
      if (started.process->has_ended()) {
        const auto failure = started.process->failure();
        if (!failure) return;  // it was on the ring between two looks
        throw NotMet{fmt::format("program '{}' ended before node '{}' was on the ring: {}",
                                 program_name, wanted.node, *failure)};
      }
      if (clock.now() >= latest)
        throw NotMet{fmt::format("node '{}' of program '{}' was not on the ring within {:g} s",
                                 wanted.node, program_name, wanted.ready_s)};
      clock.sleep_until(clock.now() + kStartLook);
    }
  }

  void check_programs() {
    for (auto& [program_name, started] : programs)
      if (!started.is_killed && started.process->has_ended())
        if (const auto failure = started.process->failure()) throw NotMet{*failure};
    for (const auto& [node, link] : links)
      if (const auto trouble = link->trouble(); !trouble.empty()) throw Error{trouble};
    check_stores();
  }

  void check_stores() {
    if (const auto text = recorder->foreign_log().first(); !text.empty()) throw NotMet{text};
    for (const auto& [node, link] : links)
      if (const auto text = link->foreign_log().first(); !text.empty()) throw NotMet{text};
  }

  [[nodiscard]] bool has_suspicion() const {
    return recorder->foreign_log().has_suspicion() ||
           std::any_of(links.begin(), links.end(),
                       [](const auto& link) { return link.second->foreign_log().has_suspicion(); });
  }

  void end_programs() {
    for (auto& [program_name, started] : programs) {
      if (started.process->has_ended()) continue;
      ::kill(-started.process->process(), SIGCONT);
      started.process->ask_to_end();
    }
    const TimePoint latest = WallClock{}.now() + kGrace;
    for (auto& [program_name, started] : programs)
      started.process->wait(latest - WallClock{}.now());
    for (auto& [program_name, started] : programs)
      ::kill(-started.process->process(), SIGKILL);  // also those that it has started and left
    programs.clear();
  }
};

Laboratory::Laboratory(std::filesystem::path folder, const std::string& map, double deadline_s)
    : state_{std::make_unique<State>()} {
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  state_->folder = std::move(folder);
  state_->deadline = WallClock{}.now() + duration_of("deadline_s", deadline_s);
  remove_rings_of_killed_tests();
  state_->ring = SignalRing::create(state_->name, find_map(map).string());
  state_->observer = state_->ring->observe();
  state_->recorder.emplace(state_->name);
}

Laboratory::~Laboratory() { close(); }

const std::string& Laboratory::name() const { return state_->name; }
const std::filesystem::path& Laboratory::folder() const { return state_->folder; }
const std::shared_ptr<SignalRing>& Laboratory::ring() const { return state_->ring; }

void Laboratory::start(const Program& program) {
  const std::string name = program.name.empty() ? program.node : program.name;
  if (name.empty() || name.find('/') != std::string::npos)
    throw Error{fmt::format("the name of the program is '{}', expected a name", name)};
  if (state_->programs.contains(name))
    throw Error{fmt::format("program '{}' was started before, expected another name", name)};
  if (program.command.empty()) throw Error{fmt::format("program '{}' has no command", name)};
  static_cast<void>(duration_of("ready_s", program.ready_s));
  if (!program.node.empty()) static_cast<void>(state_->ring->map().node(program.node));
  std::string ring = state_->name;
  if (program.is_linked) {
    auto link = state_->links.find(program.node);
    if (link == state_->links.end()) {
      auto made = std::make_unique<Link>(ring, state_->ring->map(), program.node);
      link = state_->links.emplace(program.node, std::move(made)).first;
    }
    ring = link->second->image();
  }
  State::Started started;
  auto start = start_of(program, name, ring);
  start.log = state_->folder / (name + ".log");
  started.process = std::make_unique<adapters::ChildProgram>(start);
  state_->programs.emplace(name, std::move(started));
  if (!program.node.empty()) state_->wait_for_node(program, name);
}

std::unique_ptr<SignalNode> Laboratory::join(const std::string& node) {
  return state_->ring->join(node);
}

double Laboratory::read(const std::string& signal) { return state_->observer->read(signal); }

std::string Laboratory::log(const std::string& program) const {
  return read_file(state_->folder / (program + ".log"), kMostLogBytes);
}

void Laboratory::kill(const std::string& program) {
  State::Started& started = state_->program(program);
  started.is_killed = true;
  if (started.process->has_ended()) return;
  ::kill(-started.process->process(), SIGKILL);
  started.process->wait(kGrace);
}

void Laboratory::freeze(const std::string& program) {
  auto& process = *state_->program(program).process;
  if (!process.has_ended()) ::kill(-process.process(), SIGSTOP);
}

void Laboratory::thaw(const std::string& program) {
  auto& process = *state_->program(program).process;
  if (!process.has_ended()) ::kill(-process.process(), SIGCONT);
}

void Laboratory::drop(const std::string& node) {
  state_->link(node).change_faults([](auto& faults) { faults.drops_all = true; });
}

void Laboratory::drop_signal(const std::string& signal) {
  const auto& entry = state_->ring->entry(signal);
  const std::uint32_t offset = entry.signal->offset.value();
  state_->link_of(entry).change_faults([&](auto& faults) { faults.dropped.insert(offset); });
}

void Laboratory::delay(const std::string& node, double seconds) {
  state_->link(node).change_faults(
      [delay = duration_of("the delay", seconds)](auto& faults) { faults.delay = delay; });
}

void Laboratory::flip(const std::string& signal, int bit) {
  if (bit < 0 || bit > 31) throw Error{fmt::format("the bit is {}, expected 0 to 31", bit)};
  const auto& entry = state_->ring->entry(signal);
  state_->link_of(entry).change_faults(
      [&](auto& faults) { faults.flips[entry.signal->offset.value()] ^= std::uint32_t{1} << bit; });
}

void Laboratory::restore(const std::string& node) {
  state_->link(node).change_faults([](auto& faults) { faults = {}; });
}

double Laboratory::expect_within(double seconds, const std::string& signal,
                                 const Condition& condition) {
  const Condition wanted = condition.of(*state_->ring, signal);
  bool is_met = false;
  const double value = state_->follow(seconds, signal, [&](double now) {
    is_met = wanted.is_met(now);
    return is_met;
  });
  check_programs();
  if (!is_met)
    throw NotMet{fmt::format("{}: expected {} within {:g} s, last value {}", signal, wanted.text(),
                             seconds, quantity(*state_->ring, signal, value))};
  return value;
}

double Laboratory::eventually(const std::string& signal, const Condition& condition) {
  return expect_within(kEventually, signal, condition);
}

void Laboratory::never(double seconds, const std::string& signal, const Condition& condition) {
  const WallClock clock;
  const TimePoint begun = clock.now();
  const Condition unwanted = condition.of(*state_->ring, signal);
  bool is_met = false;
  const double value = state_->follow(seconds, signal, [&](double now) {
    is_met = unwanted.is_met(now);
    return is_met;
  });
  check_programs();
  if (is_met)
    throw NotMet{fmt::format("{}: expected never {}, found {} after {:.3f} s", signal,
                             unwanted.text(), quantity(*state_->ring, signal, value),
                             to_seconds(clock.now() - begun))};
}

void Laboratory::expect_end(double seconds, const std::string& program) {
  WallClock clock;
  auto& process = *state_->program(program).process;
  const TimePoint latest =
      std::min(state_->deadline, clock.now() + duration_of("the time", seconds));
  while (!process.has_ended() && clock.now() < latest) {
    check_programs();
    process.wait(kProgramLook);
  }
  check_programs();
  if (!process.has_ended())
    throw NotMet{fmt::format("program '{}' did not end within {:g} s", program, seconds)};
}

bool Laboratory::has_ended(const std::string& program) {
  return state_->program(program).process->has_ended();
}

void Laboratory::check_programs() { state_->check_programs(); }

// The thread makes the last look after this call has begun.
void Laboratory::check_owners() {
  if (!state_->ring) return;
  WallClock clock;
  const TimePoint latest = clock.now() + kLongestJudgement;
  do clock.sleep_until(clock.now() + kLastLooks);
  while (state_->has_suspicion() && clock.now() < latest);
  state_->check_stores();
}

void Laboratory::close() {
  if (!state_->ring) return;
  state_->end_programs();
  state_->links.clear();
  state_->recorder->end();
  state_->observer.reset();
  state_->ring.reset();
  broker::remove_ring(state_->name);
}

void Laboratory::keep() {
  close();
  state_->recorder->write(state_->folder / "run.h5");
}

std::filesystem::path make_test_folder(const std::filesystem::path& kept, const std::string& test) {
  std::string name = test;
  for (auto& letter : name)
    if (!is_letter_or_digit(letter) && letter != '-' && letter != '.') letter = '_';
  const auto folder = kept / fmt::format("{}_{}", name, new_name());
  constexpr int kMostRivals = 100;  // tests that remove empty folders above this one meanwhile
  std::error_code error;
  for (int i = 0; i < kMostRivals; ++i) {
    std::filesystem::create_directories(folder, error);
    if (error != std::errc::no_such_file_or_directory) break;
  }
  if (error) throw Error{fmt::format("{}: {}", folder.string(), error.message())};
  return folder;
}

void remove_test_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  const auto kept = folder.parent_path();  // these if they are empty
  std::filesystem::remove(kept, ignored);
  if (kept.filename() == "failed_tests" && kept.parent_path().filename() == "out")
    std::filesystem::remove(kept.parent_path(), ignored);
}

}  // namespace rths::testkit

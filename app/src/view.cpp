// SPDX-License-Identifier: Apache-2.0
//
// `view` and `top`: a ring as it is seen from outside.
#include <sys/random.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/text.hpp>
#include <rths/monitor/look.hpp>
#include <rths/monitor/server.hpp>
#include <rths/report/comparison.hpp>
#include <rths/session/folder.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

constexpr std::uint16_t kPort = 8017;
constexpr Duration kUpdateEvery = std::chrono::milliseconds{10};
constexpr int kLessUrgent = 5;  // than all that has work to do for the test

struct ViewArguments {
  std::string ring;
  std::optional<std::uint16_t> port;
  bool controls = false;
  std::string listen, token;
  std::string runs = "out";
  std::string experiment;
  std::vector<std::string> sets;
  long timeout_ms = 0;  ///< end after this time; 0: never
};

std::string new_token() {
  std::uint64_t random[2] = {};
  if (getrandom(random, sizeof random, 0) != static_cast<ssize_t>(sizeof random))
    throw Error{"the system gives no random number for a token; state --token"};
  return fmt::format("{:016x}{:016x}", random[0], random[1]);
}

// The roles that the built-in map of this name states, else those of the SRMD.
recording::Roles usual_roles(const memmap::Map& map) {
  const std::string& name = map.description().name;
  Config roles;
  if (contains(built_in_names("maps"), name))
    roles = recording::with_map_roles({}, Config::load(find_map(name)).table_or_empty("roles"));
  return recording::read_roles(roles);
}

std::string compared(const std::filesystem::path& baseline, const std::filesystem::path& other) {
  constexpr std::size_t kMostSignals = 40;
  return report::text_of(
      report::compare(session::recording_in(baseline), session::recording_in(other), {}),
      kMostSignals);
}

monitor::ServerSettings settings_of(const ViewArguments& a) {
  monitor::ServerSettings settings;
  settings.ring = a.ring;
  settings.listen = a.listen;
  settings.port = a.port.value_or(kPort);
  settings.controls = a.controls;
  settings.token = a.token;
  if (a.token.empty() && (a.controls || !a.listen.empty())) settings.token = new_token();
  settings.runs = a.runs;
  settings.roles_of = usual_roles;
  settings.compare = compared;
  if (!a.experiment.empty()) {
    const auto experiment = load_experiment(a.experiment, split_changes(a.sets));
    settings.roles_of = [roles = experiment.roles](const memmap::Map&) { return roles; };
    for (const auto& node : experiment.nodes)
      for (const auto& [axis, limit] : node.settings.safety_limits)
        settings.limits.push_back({axis, limit.displacement, limit.force, limit.tracking});
    if (settings.ring.empty()) settings.ring = experiment.name;
  }
  return settings;
}

// The usual port, or any if another page has it.
std::unique_ptr<monitor::PageServer> serve(const ViewArguments& a) {
  monitor::ServerSettings settings = settings_of(a);
  if (a.port) return std::make_unique<monitor::PageServer>(settings);
  try {
    return std::make_unique<monitor::PageServer>(settings);
  } catch (const Error&) {
    if (!a.listen.empty()) throw;  // the address may be at fault
    settings.port = 0;
    return std::make_unique<monitor::PageServer>(settings);
  }
}

// Acts every 10 ms until a signal, the end of the time, or the function returns true.
template <class Function>
void repeat(long timeout_ms, const Function& act) {
  const auto begun = std::chrono::steady_clock::now();
  WallClock clock;
  while (!rths::is_interrupted()) {
    const auto elapsed = std::chrono::steady_clock::now() - begun;
    if (timeout_ms > 0 && elapsed >= std::chrono::milliseconds{timeout_ms}) return;
    if (act(elapsed)) return;
    clock.sleep_until(clock.now() + kUpdateEvery);
  }
}

int view(const ViewArguments& a) {
  static_cast<void>(!nice(kLessUrgent));
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  const Interruptible interruptible;
  const auto server = serve(a);
  fmt::print("view      {}\n", server->url());
  if (std::getenv("SSH_CONNECTION") != nullptr && a.listen.empty())
    fmt::print("over ssh  forward port {0}: ssh -L {0}:127.0.0.1:{0} HOST\n", server->port());
  std::fflush(stdout);
  repeat(a.timeout_ms, [](const auto&) { return false; });
  return kOk;
}

struct TopArguments {
  std::string ring;
  std::string format = "text";
  bool once = false;
};

std::string only_ring() {
  const auto rings = broker::list_rings();
  if (rings.size() == 1) return rings.front().name;
  std::string names;
  for (const auto& ring : rings) names += (names.empty() ? "" : ", ") + ring.name;
  throw Error{rings.empty() ? "there is no ring on this host; start its run first"
                            : "there are several rings, expected the name of one of " + names};
}

void print(const monitor::RingLook& look, bool as_json, bool clears) {
  constexpr const char* kHomeAndClear = "\033[H\033[J";
  if (as_json)
    fmt::print("{}\n", json_of(look));
  else
    fmt::print("{}{}", clears ? kHomeAndClear : "", text_of(look));
  std::fflush(stdout);
}

// Rates need a second of heartbeats.
int top(const TopArguments& a) {
  constexpr auto kFirst = std::chrono::milliseconds{1200}, kEvery = std::chrono::milliseconds{500};
  static_cast<void>(!nice(kLessUrgent));
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  const Interruptible interruptible;
  monitor::RingLook look{a.ring.empty() ? only_ring() : a.ring, 0};
  const bool as_json = a.format == "json";
  const bool clears = !as_json && !a.once && isatty(STDOUT_FILENO) != 0;
  std::chrono::nanoseconds next = a.once ? kFirst : kEvery;
  bool has_ended = false;
  repeat(0, [&](std::chrono::nanoseconds elapsed) {
    look.update();
    if (elapsed < next) return false;
    next += kEvery;
    print(look, as_json, clears);
    has_ended = !look.is_current();
    return a.once || has_ended || std::ferror(stdout) != 0;
  });
  if (has_ended && !as_json) fmt::print("the ring has ended\n");
  return kOk;
}

}  // namespace

void add_view(CommandLine& line) {
  auto [command, a] = line.add("view", "Serve a page that shows a ring live", view);
  command->add_option("ring", a.ring,
                      "Name of a ring, also of one that is not there yet [the first]");
  command->add_option("--port", a.port, "Port of the page [8017, or a free one]");
  command->add_flag("--control", a.controls, "Parameters can be changed, with the token");
  command->add_option("--listen", a.listen,
                      "Address of a network interface, for other hosts with the token [loopback]");
  command->add_option("--token", a.token, "For --control and --listen [a new one]");
  command->add_option("--runs", a.runs, "Folder with the results of runs")->capture_default_str();
  auto* experiment =
      command->add_option("--experiment", a.experiment,
                          "Experiment file, for words and limits of the test [words by the map]");
  repeatable(command->add_option("--set", a.sets, "As for the run: key=value"))->needs(experiment);
  command->add_option("-T,--timeout", a.timeout_ms, "End after this time [ms]")
      ->check(not_negative());
}

void add_top(CommandLine& line) {
  auto [command, a] =
      line.add("top", "Show nodes, rates, lateness and safety state of a ring in a terminal", top);
  command->add_option("ring", a.ring, "Name of a ring [the only one]");
  command->add_flag("--once", a.once, "Print the state once, after a second");
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "json"}));
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/broker/watch_text.hpp>

#include "command.hpp"
#include "commands.hpp"

namespace rths::app {
namespace {

struct WatchArguments {
  std::string ring;
  long period_us = 50;  ///< between two scans
  long timeout_ms = 0;  ///< stop after this time; 0: never
};

using std::chrono::steady_clock;

// Prints address, value, owner of the word, and the processes that may have stored it.
void print_store(const broker::PlainStore& store, TimePoint begun) {
  fmt::print("({:.3f}) longword {} (byte {}) = {:#010x}: {}; stored without a journal by {}\n",
             to_seconds(store.seen - begun), store.offset.value(),
             to_byte_offset(store.offset).value(), store.value,
             store.owner.empty() ? "no owner" : "owner " + store.owner, broker::writers_of(store));
  std::fflush(stdout);
}

int watch(const WatchArguments& arguments) {
  broker::Ring ring = broker::Ring::attach(arguments.ring);
  broker::Watch watch{ring};
  const TimePoint begun = WallClock{}.now();
  const auto until = steady_clock::now() + std::chrono::milliseconds{arguments.timeout_ms};
  bool found = false;
  do {
    for (const auto& store : watch.look()) {
      if (store.allowed) continue;
      print_store(store, begun);
      found = true;
    }
    std::this_thread::sleep_for(std::chrono::microseconds{arguments.period_us});
  } while (arguments.timeout_ms == 0 || steady_clock::now() < until);
  return found ? kConditionNotMet : kOk;
}

}  // namespace

void add_watch(CommandLine& line) {
  auto& a = line.values<WatchArguments>();
  auto* command = line.app.add_subcommand(
      "watch",
      "Journal stores of clients that bypass the API; print stores into other nodes' words");
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command->add_option("--period-us", a.period_us, "Time between two scans [50]")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("-T,--timeout", a.timeout_ms, "Stop after this time [ms]")
      ->check(CLI::NonNegativeNumber);
  command->callback([&] { line.chosen = [&a] { return watch(a); }; });
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/broker/follow.hpp>
#include <rths/broker/watch_text.hpp>
#include <rths/memmap/codec.hpp>

#include "command.hpp"
#include "patterns.hpp"

namespace rths::app {
namespace {

struct WhoArguments {
  std::string ring;
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell
  std::string format = "text";        ///< text or json, one object per line
};

std::string ago(TimePoint time, TimePoint now) {
  const double milliseconds = 1e3 * to_seconds(now - time);
  return fmt::format("{:.3f} ms", std::max(0.0, milliseconds));
}

// "by srmd, 0.210 to 1.200 ms ago": the write lies between two journal entries with a time.
std::string describe(const broker::LastWrite& last, TimePoint now) {
  const bool bounded_below = last.not_before.count() != 0;
  const bool bounded_above = last.not_after.count() != 0;
  if (!last.value)
    return bounded_above ? fmt::format("belongs to {}, not written in the last {}", last.node,
                                       ago(last.not_after, now))
                         : fmt::format("belongs to {}, no write in its journal", last.node);
  const std::string newest = bounded_above ? ago(last.not_after, now) : "0 ms";
  return bounded_below
             ? fmt::format("by {}, {} to {} ago", last.node, newest, ago(last.not_before, now))
             : fmt::format("by {}, at least {} ago", last.node, newest);
}

// An unknown age is null.
nlohmann::ordered_json age_ms(TimePoint time, TimePoint now) {
  if (time.count() == 0) return nullptr;
  return std::max(0.0, 1e3 * to_seconds(now - time));
}

/// Stores by other processes than the owners, by longword.
using ForeignStores = std::map<std::uint32_t, broker::PlainStore>;

// Stores that appear while this looks.
ForeignStores stores_of_a_moment(broker::Ring& ring) {
  constexpr int kLooks = 150;  // 1 ms apart
  ForeignStores found;
  broker::Watch watch{ring, broker::Journalling::None};
  WallClock clock;
  for (int i = 0; i < kLooks; ++i) {
    for (auto& store : watch.look())
      if (!store.owner.empty()) found.try_emplace(store.offset.value(), std::move(store));
    clock.sleep_until(clock.now() + std::chrono::milliseconds{1});
  }
  return found;
}

// Words that differ from the journal of their owner, which is on the ring and journals its writes.
ForeignStores differing_words(broker::Ring& ring, const broker::RingReport& report,
                              const broker::Node& node) {
  ForeignStores found;
  for (const auto& entry : ring.map().signals()) {
    const auto offset = entry.signal->offset;
    const std::string& owner = entry.partition->node;
    const bool journals =
        std::any_of(report.occupants.begin(), report.occupants.end(), [&](const auto& occupant) {
          return occupant.node == owner && occupant.alive && !occupant.plain;
        });
    if (!journals) continue;
    const std::uint32_t word = node.read(offset);
    const auto last = ring.last_write(offset);
    if (last.value && *last.value != word)
      found[offset.value()] = {offset, word, owner, false, {}, last.not_after};
  }
  return found;
}

// A journal is behind a word for a moment only, so words that differ are read twice.
ForeignStores foreign_stores(broker::Ring& ring, const std::string& name,
                             const broker::Node& node) {
  const auto report = broker::inspect_ring(name);
  if (!report) return {};
  auto before = differing_words(ring, *report, node);
  ForeignStores found = stores_of_a_moment(ring);
  const auto after = differing_words(ring, *report, node);
  for (auto& [offset, store] : before) {
    const auto still = after.find(offset);
    if (still == after.end() || still->second.value != store.value) continue;
    for (const auto& occupant : report->occupants)
      if (occupant.plain && occupant.alive)
        store.others.push_back(fmt::format("{} ({})", occupant.node, occupant.process));
    found.try_emplace(offset, store);
  }
  return found;
}

std::string foreign_text(const memmap::Map& map, const broker::PlainStore& store, TimePoint now) {
  return fmt::format("; but stored as {} by {}{}, expected stores by its owner {} alone",
                     broker::word_value(map, store.offset, store.value), broker::writers_of(store),
                     store.seen.count() == 0 ? "" : ", seen " + ago(store.seen, now) + " ago",
                     store.owner);
}

nlohmann::ordered_json json_of(const memmap::SignalEntry& entry, double value,
                               const broker::LastWrite& last, TimePoint now) {
  return {{"signal", entry.name},
          {"value", value},
          {"unit", entry.signal->unit},
          {"node", last.node},
          {"written", last.value.has_value()},
          {"age_min_ms", age_ms(last.not_after, now)},
          {"age_max_ms", age_ms(last.not_before, now)}};
}

int who(const WhoArguments& arguments) {
  broker::Ring ring = broker::Ring::attach(arguments.ring);
  const broker::Node node = ring.observe();
  const auto foreign = foreign_stores(ring, arguments.ring, node);
  bool is_foreign = false;
  for (const auto* found : selected_signals(ring, arguments.ring, arguments.patterns)) {
    const auto& entry = *found;
    const memmap::Codec codec{*entry.signal};
    const auto offset = entry.signal->offset;
    const double value = codec.from_si(codec.decode(node.read(offset)));
    const auto last = ring.last_write(offset);
    const TimePoint now = WallClock{}.now();
    const auto store = foreign.find(offset.value());
    const bool is_stored = store != foreign.end();
    is_foreign = is_foreign || is_stored;
    if (arguments.format == "json") {
      auto line = json_of(entry, value, last, now);
      if (is_stored) line["foreign_writers"] = broker::writers_of(store->second);
      fmt::print("{}\n", line.dump());
      continue;
    }
    fmt::print("{} = {:.7g} {}: {}{}\n", entry.name, value,
               entry.signal->unit == "1" ? "" : entry.signal->unit, describe(last, now),
               is_stored ? foreign_text(ring.map(), store->second, now) : "");
  }
  return is_foreign ? kConditionNotMet : kOk;
}

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

void add_who(CommandLine& line) {
  auto [command, a] = line.add("who", "Print the last writer and write time of words", who);
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command->add_option("signals", a.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "json"}));
}

void add_watch(CommandLine& line) {
  auto [command, a] = line.add(
      "watch",
      "Journal stores of clients that bypass the API; print stores into other nodes' words", watch);
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command->add_option("--period-us", a.period_us, "Time between two scans [50]")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("-T,--timeout", a.timeout_ms, "Stop after this time [ms]")
      ->check(not_negative());
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>

#include "commands.hpp"
#include "patterns.hpp"

namespace rths::app {
namespace {

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

}  // namespace

int who(const WhoArguments& arguments) {
  broker::Ring ring = broker::Ring::attach(arguments.ring);
  const broker::Node node = ring.observe();
  for (const auto* found : selected_signals(ring, arguments.ring, arguments.patterns)) {
    const auto& entry = *found;
    const memmap::Codec codec{*entry.signal};
    const auto offset = entry.signal->offset;
    const double value = codec.from_si(codec.decode(node.read(offset)));
    const auto last = ring.last_write(offset);
    const TimePoint now = WallClock{}.now();
    if (arguments.format == "json")
      fmt::print("{}\n", json_of(entry, value, last, now).dump());
    else
      fmt::print("{} = {:.7g} {}: {}\n", entry.name, value,
                 entry.signal->unit == "1" ? "" : entry.signal->unit, describe(last, now));
  }
  return kOk;
}

}  // namespace rths::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

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

}  // namespace

int who(const std::string& name, const std::vector<std::string>& patterns) {
  broker::Ring ring = broker::Ring::attach(name);
  const broker::Node node = ring.observe();
  bool any = false;
  for (const auto& entry : ring.map().signals()) {
    if (!matches(entry.name, patterns)) continue;
    any = true;
    const memmap::Codec codec{*entry.signal};
    const auto offset = entry.signal->offset;
    fmt::print("{} = {:.7g} {}: {}\n", entry.name, codec.from_si(codec.decode(node.read(offset))),
               entry.signal->unit == "1" ? "" : entry.signal->unit,
               describe(ring.last_write(offset), WallClock{}.now()));
  }
  if (!any) throw Error{"no signal of the ring matches"};
  return kOk;
}

}  // namespace rths::app

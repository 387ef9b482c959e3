// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/message_fault.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/text.hpp>

namespace rths::recording {
namespace {

constexpr double kLongest = 86'400;  // [s]

// Node whose writes a fault changes; the owner of its signal.
std::string node_of(const Config& table, const memmap::Map& map, const std::string& signal) {
  if (!signal.empty())
    return table.placed("signal", [&] { return map.entry(map.signal(signal)).partition->node; });
  const std::string node = table.text("node");
  static_cast<void>(table.placed("node", [&] { return map.node(node); }));
  return node;
}

}  // namespace

MessageFault read_message_fault(const Config& table, const memmap::Map& map,
                                const std::vector<std::string>& others) {
  std::vector<std::string> kinds = others;
  kinds.insert(kinds.end(), {"drop", "delay", "flip"});
  MessageFault fault;
  fault.at = table.number_in("at_s", 0, kLongest, 0.0);
  fault.kind = table.text("kind");
  if (!contains(kinds, fault.kind))
    table.fail("kind",
               fmt::format("kind is '{}', expected one of {}", fault.kind, fmt::join(kinds, ", ")));
  if (fault.kind == "drop" || fault.kind == "flip") fault.signal = table.text("signal", "");
  if (fault.kind == "flip" && fault.signal.empty()) fault.signal = table.text("signal");
  fault.node = node_of(table, map, fault.signal);
  if (fault.kind != "kill" && table.has("for_s"))
    fault.lasting = table.number_in("for_s", 0, kLongest);
  if (fault.kind == "delay") fault.delay = table.number_in("delay_s", 0, kLongest);
  if (fault.kind == "flip") fault.bit = static_cast<int>(table.integer_in("bit", 0, 31));
  table.reject_unknown_keys();
  return fault;
}

}  // namespace rths::recording

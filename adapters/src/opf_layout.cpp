// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opf_layout.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/units.hpp>

namespace rths::adapters {
namespace {

constexpr const char* kOrder = "newTarget, commands, switchPC, atTarget, feedbacks";

std::optional<OpfQuantity> quantity_named(const std::string& word) {
  if (word == "displ") return OpfQuantity::Displacement;
  if (word == "veloc") return OpfQuantity::Velocity;
  if (word == "accel") return OpfQuantity::Acceleration;
  if (word == "force" || word == "moment") return OpfQuantity::Force;
  if (word == "time") return OpfQuantity::Time;
  return std::nullopt;
}

template <class T>
std::pair<double, double> limits_of() {
  return {static_cast<double>(std::numeric_limits<T>::lowest()),
          static_cast<double>(std::numeric_limits<T>::max())};
}

// Lowest and highest value of a word, in the map's unit.
std::pair<double, double> limits(const memmap::Signal& signal) {
  if (signal.range) return *signal.range;
  if (signal.type == memmap::WordType::I32) return limits_of<std::int32_t>();
  return signal.type == memmap::WordType::U32 ? limits_of<std::uint32_t>() : limits_of<float>();
}

// "long.displ.target", or "displ.target" with a single axis.
OpfSignal read_signal(const memmap::SignalEntry& entry, const std::string& ending) {
  const std::string& name = entry.signal->name;
  const auto fail = [&] {
    throw Error{fmt::format("{}: '{}' is not an OpenFresco signal, expected <axis>.<quantity>.{}",
                            entry.signal->where, entry.name, ending)};
  };
  const std::size_t end = name.rfind('.' + ending);
  if (end == std::string::npos || end + ending.size() + 1 != name.size()) fail();
  const std::string head = name.substr(0, end);
  const std::size_t dot = head.rfind('.');
  const auto quantity = quantity_named(dot == std::string::npos ? head : head.substr(dot + 1));
  if (!quantity) fail();
  const auto unit = memmap::parse_unit(entry.signal->unit);
  const memmap::Codec codec{*entry.signal};
  const auto [lowest, highest] = limits(*entry.signal);
  return {entry.name,          dot == std::string::npos ? "1" : head.substr(0, dot),
          *quantity,           unit.si,
          unit.scale,          codec.to_si(lowest),
          codec.to_si(highest)};
}

std::vector<memmap::SignalEntry> signals_of(const memmap::Map& map, const std::string& partition) {
  std::vector<memmap::SignalEntry> signals;
  for (const auto& entry : map.signals())
    if (entry.partition->name == partition) signals.push_back(entry);
  return signals;
}

// OpenFresco counts words: a gap would shift all words after it.
void require_no_gap(const memmap::Map& map, const std::vector<memmap::SignalEntry>& signals) {
  for (std::size_t i = 1; i < signals.size(); ++i)
    if (signals[i].signal->offset != advance(signals[i - 1].signal->offset, 1))
      throw Error{fmt::format("map '{}': OpenFresco's block has a gap before '{}'",
                              map.description().name, signals[i].name)};
}

}  // namespace

const char* to_text(OpfQuantity quantity) noexcept {
  constexpr const char* kNames[] = {"disp", "vel", "accel", "force", "time"};
  return kNames[static_cast<std::size_t>(quantity)];
}

const OpfSignal* OpfLayout::find(const std::vector<OpfSignal>& signals, const std::string& axis,
                                 OpfQuantity quantity) {
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const OpfSignal& signal) {
    return signal.axis == axis && signal.quantity == quantity;
  });
  return found == signals.end() ? nullptr : &*found;
}

OpfLayout opf_layout(const memmap::Map& map) {
  const auto opf = signals_of(map, "opf"), daq = signals_of(map, "daq");
  const std::string& name = map.description().name;
  if (opf.empty() || daq.empty())
    throw Error{fmt::format("map '{}' has no block for OpenFresco: partitions opf and daq", name)};
  if (opf[0].signal->name != "newTarget" || daq.size() < 2 || daq[0].signal->name != "switchPC" ||
      daq[1].signal->name != "atTarget")
    throw Error{fmt::format("map '{}': OpenFresco's block is not {}", name, kOrder)};
  require_no_gap(map, opf);
  require_no_gap(map, daq);
  OpfLayout layout;
  for (std::size_t i = 1; i < opf.size(); ++i)
    layout.commands.push_back(read_signal(opf[i], "target"));
  for (std::size_t i = 2; i < daq.size(); ++i)
    layout.feedbacks.push_back(read_signal(daq[i], "fbk"));
  return layout;
}

}  // namespace rths::adapters

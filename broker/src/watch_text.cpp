// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/watch_text.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/memmap/codec.hpp>
#include <rths/memmap/units.hpp>

namespace rths::broker {
namespace {

const memmap::SignalEntry* signal_of(const memmap::Map& map, LongwordOffset offset) {
  const auto& signals = map.signals();
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const auto& entry) {
    return entry.signal->offset == offset;
  });
  return found == signals.end() ? nullptr : &*found;
}

}  // namespace

std::string word_name(const memmap::Map& map, LongwordOffset offset) {
  const auto* entry = signal_of(map, offset);
  return entry == nullptr ? fmt::format("longword {}", offset.value()) : entry->name;
}

std::string word_value(const memmap::Map& map, LongwordOffset offset, std::uint32_t word) {
  const auto* entry = signal_of(map, offset);
  if (entry == nullptr) return fmt::format("{:#010x}", word);
  const memmap::Codec codec{*entry->signal};
  const auto unit = memmap::parse_unit(entry->signal->unit);
  return fmt::format("{:.7g}{}", codec.decode(word), unit.si == "1" ? "" : " " + unit.si);
}

std::string writers_of(const PlainStore& store) {
  return store.others.empty() ? "an unknown process"
                              : fmt::format("{}", fmt::join(store.others, " or "));
}

}  // namespace rths::broker

// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/signals.hpp>

#include <cmath>
#include <map>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::testkit {
namespace {

std::size_t index_in_group(const memmap::SignalEntry& entry) {
  return entry.signal->offset.value() - entry.partition->base.value();
}

std::uint32_t word_of(const memmap::SignalEntry& entry, const memmap::Codec& codec, double si) {
  if (!std::isfinite(si))
    throw Error{fmt::format("{}={}: expected a finite number", entry.name, si)};
  if (const auto& range = entry.signal->range) {
    const double number = codec.from_si(si);
    if (number < range->first || number > range->second)
      throw Error{fmt::format("{}={}: expected {} to {} in SI, {} to {} {}", entry.name, si,
                              codec.to_si(range->first), codec.to_si(range->second), range->first,
                              range->second, entry.signal->unit)};
  }
  const std::uint32_t word = codec.encode(si);
  if (!std::isfinite(codec.decode(word)))
    throw Error{fmt::format("{}={}: too large for the type of the word", entry.name, si)};
  return word;
}

}  // namespace

broker::Node& SignalNode::node() {
  if (!node_)
    throw Error{name_.empty() ? "this observer has left the ring"
                              : fmt::format("node '{}' has left the ring", name_)};
  return *node_;
}

void SignalNode::check_memory() {
  if (node().is_ring_lost()) throw Error{"the memory of the ring was lost: it was truncated"};
}

std::vector<std::uint32_t> SignalNode::group_of(const memmap::Partition& partition) {
  std::vector<std::uint32_t> words(partition.longwords);
  if (node().read_group(ring_->ring().tear_group(partition.name), words) != Status::Ok)
    throw Error{
        fmt::format("partition '{}': its writer interferes with each read", partition.name)};
  return words;
}

std::vector<double> SignalNode::read(const std::vector<std::string>& signals) {
  std::map<const memmap::Partition*, std::vector<std::uint32_t>> groups;
  std::vector<double> values;
  for (const auto& signal : signals) {
    const auto& entry = ring_->entry(signal);
    const auto& codec = ring_->codec(entry);
    if (!entry.partition->tear_group) {
      values.push_back(codec.decode(node().read(entry.signal->offset)));
      continue;
    }
    auto& words = groups[entry.partition];
    if (words.empty()) words = group_of(*entry.partition);
    values.push_back(codec.decode(words[index_in_group(entry)]));
  }
  check_memory();
  return values;
}

void SignalNode::check_owner(const memmap::SignalEntry& entry) {
  if (name_.empty())
    throw Error{fmt::format("{}: this program observes the ring; join as node '{}' to write it",
                            entry.name, entry.partition->node)};
  if (entry.partition->node != name_)
    throw Error{fmt::format("{}: belongs to node '{}', this program is node '{}'", entry.name,
                            entry.partition->node, name_)};
  if (!node().plain_memory().empty())
    throw Error{fmt::format("{}: node '{}' joined as plain, so it stores through view() only",
                            entry.name, name_)};
}

void SignalNode::write_word(const memmap::SignalEntry& entry, std::uint32_t word) {
  if (node().write(entry.signal->offset, word) != Status::Ok)
    throw Error{fmt::format("{}: the ring refused the write", entry.name)};
}

void SignalNode::write(const std::vector<std::pair<std::string, Value>>& values) {
  std::vector<std::pair<const memmap::SignalEntry*, std::uint32_t>> words;
  std::map<const memmap::Partition*, std::vector<std::uint32_t>> groups;
  for (const auto& [signal, value] : values) {
    const auto& entry = ring_->entry(signal);
    check_owner(entry);
    const std::uint32_t word = word_of(entry, ring_->codec(entry), ring_->number(entry, value));
    words.emplace_back(&entry, word);
    if (!entry.partition->tear_group) continue;
    auto& group = groups[entry.partition];
    if (group.empty()) group = group_of(*entry.partition);
    group[index_in_group(entry)] = word;
  }
  for (const auto& [entry, word] : words) {
    if (!entry->partition->tear_group) {
      write_word(*entry, word);
      continue;
    }
    // In the place of the first of its words.
    const auto group = groups.find(entry->partition);
    if (group == groups.end()) continue;
    if (node().write_group(ring_->ring().tear_group(entry->partition->name), group->second) !=
        Status::Ok)
      throw Error{
          fmt::format("partition '{}': the ring refused the write", entry->partition->name)};
    groups.erase(group);
  }
  check_memory();
}

SignalNode::Words SignalNode::words_of(const std::string& partition) {
  const auto& found = ring_->partition(partition);
  const bool is_writable = found.node == name_ && !node().plain_memory().empty();
  return {node().memory().subspan(found.base.value(), found.longwords), is_writable};
}

std::uint64_t SignalNode::beats_of(const std::string& other) {
  return node().beats_of(ring_->map().node(other));
}

std::string SignalNode::presence_of(const std::string& other) {
  constexpr const char* kStates[] = {"absent", "alive", "vanished"};  // as Presence::State
  return kStates[static_cast<int>(node().presence_of(ring_->map().node(other)).state)];
}

}  // namespace rths::testkit

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

SignalRing::SignalRing(broker::Ring ring)
    : ring_{std::move(ring)}, codecs_(ring_.map().signals().size()) {}

std::shared_ptr<SignalRing> SignalRing::create(const std::string& name,
                                               const std::string& map_file) {
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  return std::make_shared<SignalRing>(broker::Ring::create(name, memmap::load_map(map_file)));
}

std::shared_ptr<SignalRing> SignalRing::attach(const std::string& name) {
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  return std::make_shared<SignalRing>(broker::Ring::attach(name));
}

std::shared_ptr<SignalRing> SignalRing::in_process(const std::string& map_file) {
  return std::make_shared<SignalRing>(broker::Ring::in_process(memmap::load_map(map_file)));
}

std::unique_ptr<SignalNode> SignalRing::join(const std::string& node, bool plain) {
  return std::make_unique<SignalNode>(shared_from_this(),
                                      plain ? ring_.join_plain(node) : ring_.join(node, 0), node);
}

std::unique_ptr<SignalNode> SignalRing::observe() {
  return std::make_unique<SignalNode>(shared_from_this(), ring_.observe(), "");
}

std::unique_ptr<SignalFollower> SignalRing::follow(const std::vector<std::string>& signals) {
  return std::make_unique<SignalFollower>(shared_from_this(), signals);
}

const memmap::SignalEntry& SignalRing::entry(const std::string& signal) const {
  return map().entry(map().signal(signal));
}

const memmap::Partition& SignalRing::partition(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& partition : map().partitions()) {
    if (partition.name == name) return partition;
    names.push_back(partition.name);
  }
  throw Error{fmt::format("map '{}' has no partition '{}', expected one of: {}",
                          map().description().name, name, fmt::join(names, ", "))};
}

const memmap::Codec& SignalRing::codec(const memmap::SignalEntry& entry) {
  auto& codec = codecs_[static_cast<std::size_t>(&entry - map().signals().data())];
  if (!codec) codec.emplace(*entry.signal);
  return *codec;
}

double SignalRing::number(const memmap::SignalEntry& entry, const Value& value) {
  if (const auto* const number = std::get_if<double>(&value)) return *number;
  const auto& text = std::get<std::string>(value);
  std::vector<std::string> names;
  for (const auto& [name, named] : entry.signal->values) {
    if (name == text) return codec(entry).to_si(static_cast<double>(named));
    names.push_back(name);
  }
  throw Error{
      fmt::format("{}='{}': expected a number{}", entry.name, text,
                  names.empty() ? "" : fmt::format(" or one of: {}", fmt::join(names, ", ")))};
}

SignalFollower::SignalFollower(std::shared_ptr<SignalRing> ring,
                               const std::vector<std::string>& signals)
    : ring_{std::move(ring)} {
  if (signals.empty()) throw Error{"expected at least one signal to follow"};
  std::vector<broker::LongwordRange> words;
  for (const auto& signal : signals) {
    entries_.push_back(&ring_->entry(signal));
    words.push_back({entries_.back()->signal->offset, 1});
  }
  waiter_.emplace(ring_->ring().wait_for(words));
}

Change SignalFollower::change_of(const broker::Write& write) {
  Change change{ring_->map().node_name(write.writer), {}};
  const std::uint32_t begin = write.offset.value();
  for (const auto* const entry : entries_) {
    const std::uint32_t offset = entry->signal->offset.value();
    if (offset < begin) continue;
    if (write.group.empty() ? offset != begin : offset - begin >= write.group.size()) continue;
    const std::uint32_t word = write.group.empty() ? write.value : write.group[offset - begin];
    change.values.emplace_back(entry->name, ring_->codec(*entry).decode(word));
  }
  return change;
}

}  // namespace rths::testkit

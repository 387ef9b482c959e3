// SPDX-License-Identifier: Apache-2.0
#include "ring_handle.hpp"

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

#include "follower.hpp"
#include "member.hpp"

namespace rths::python {

RingHandle::RingHandle(broker::Ring ring)
    : ring_{std::move(ring)}, codecs_(ring_.map().signals().size()) {}

std::shared_ptr<RingHandle> RingHandle::create(const std::string& name,
                                               const std::string& map_file) {
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  return std::make_shared<RingHandle>(broker::Ring::create(name, memmap::load_map(map_file)));
}

std::shared_ptr<RingHandle> RingHandle::attach(const std::string& name) {
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  return std::make_shared<RingHandle>(broker::Ring::attach(name));
}

std::shared_ptr<RingHandle> RingHandle::in_process(const std::string& map_file) {
  return std::make_shared<RingHandle>(broker::Ring::in_process(memmap::load_map(map_file)));
}

std::unique_ptr<Member> RingHandle::join(const std::string& node, bool plain) {
  return std::make_unique<Member>(shared_from_this(),
                                  plain ? ring_.join_plain(node) : ring_.join(node, 0), node);
}

std::unique_ptr<Member> RingHandle::observe() {
  return std::make_unique<Member>(shared_from_this(), ring_.observe(), "");
}

std::unique_ptr<Follower> RingHandle::follow(const std::vector<std::string>& signals) {
  return std::make_unique<Follower>(shared_from_this(), signals);
}

const memmap::SignalEntry& RingHandle::entry(const std::string& signal) const {
  return map().entry(map().signal(signal));
}

const memmap::Partition& RingHandle::partition(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& partition : map().partitions()) {
    if (partition.name == name) return partition;
    names.push_back(partition.name);
  }
  throw Error{fmt::format("map '{}' has no partition '{}', expected one of: {}",
                          map().description().name, name, fmt::join(names, ", "))};
}

const memmap::Codec& RingHandle::codec(const memmap::SignalEntry& entry) {
  auto& codec = codecs_[static_cast<std::size_t>(&entry - map().signals().data())];
  if (!codec) codec.emplace(*entry.signal);
  return *codec;
}

}  // namespace rths::python

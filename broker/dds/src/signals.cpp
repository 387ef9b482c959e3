// SPDX-License-Identifier: Apache-2.0
#include "signals.hpp"

#include <algorithm>

namespace rths::dds {

GatewaySignals::GatewaySignals(broker::Ring& ring, const std::string& host) {
  const std::string node = "gateway_" + host, prefix = "gateway." + host;
  const auto& nodes = ring.map().description().nodes;
  if (std::none_of(nodes.begin(), nodes.end(), [&](const auto& n) { return n.name == node; }))
    return;
  node_ = ring.join(node, 0);
  for (const auto& entry : ring.map().signals())
    if (entry.partition->name == prefix && !entry.partition->tear_group)
      signals_.push_back({entry.signal->name, entry.signal->offset, memmap::Codec{*entry.signal}});
}

void GatewaySignals::set(const std::string& name, Duration value) {
  for (const auto& signal : signals_)
    if (signal.name == name)
      static_cast<void>(node_->write(signal.offset, signal.codec.encode(to_seconds(value))));
}

void GatewaySignals::write(const GatewayStatus& status) {
  if (!node_) return;
  for (const auto& node : status.nodes) {
    set("age." + node.node, node.age);
    set("delay." + node.node, node.delay);
  }
  for (const auto& host : status.hosts) {
    if (!host.clock) continue;
    set("clock_offset." + host.name, host.clock->offset);
    set("clock_error." + host.name, host.clock->error);
  }
  node_->beat();
}

}  // namespace rths::dds

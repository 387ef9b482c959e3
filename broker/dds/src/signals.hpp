// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/dds/gateway.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::dds {

/// The signals of a gateway, if the map has them: the node `gateway_<host>` writes
/// `gateway.<host>.age.<node>`, `.delay.<node>`, `.clock_offset.<host>` and `.clock_error.<host>`
/// in a unit of time. One thread.
class GatewaySignals {
 public:
  /// @param host  name of this host
  /// @throws Error if the node is on the ring already   @setup
  GatewaySignals(broker::Ring& ring, const std::string& host);
  void write(const GatewayStatus& status);

 private:
  struct Signal {
    std::string name;  ///< without the partition: "age.machine"
    LongwordOffset offset;
    memmap::Codec codec;
  };
  void set(const std::string& name, Duration value);

  std::optional<broker::Node> node_;
  std::vector<Signal> signals_;
};

}  // namespace rths::dds

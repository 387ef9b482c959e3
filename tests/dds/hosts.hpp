// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/detail/shared_object.hpp>
#include <rths/broker/ring.hpp>
#include <rths/dds/gateway.hpp>

#include "support/ring_maps.hpp"
#include "support/waiting.hpp"

namespace rths::test {

/// A host of a test: a ring with its own name, and a gateway.
class RingHost {
 public:
  RingHost(const std::string& name, const memmap::Map& map)
      : name_{name},
        removal_{unique_ring("dds_" + name)},
        ring_{broker::Ring::create(removal_.name, map)} {}

  void start(std::unique_ptr<dds::Carrier> carrier, dds::GatewayOptions options = {}) {
    options.host = name_;
    options.report = [this](const std::string& line) {
      const std::lock_guard lock{mutex_};
      lines_.push_back(line);
    };
    gateway_ = std::make_unique<dds::Gateway>(removal_.name, std::move(carrier), options);
  }
  void stop() { gateway_.reset(); }
  [[nodiscard]] broker::Ring& ring() { return ring_; }
  [[nodiscard]] const std::string& ring_name() const { return removal_.name; }
  [[nodiscard]] dds::Gateway& gateway() { return *gateway_; }
  [[nodiscard]] std::vector<std::string> lines() {
    const std::lock_guard lock{mutex_};
    return lines_;
  }

 private:
  std::string name_;
  RingRemoval removal_;
  broker::Ring ring_;
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::unique_ptr<dds::Gateway> gateway_;
};

/// Stores into a word of a ring past every API, as a stray pointer does.
inline void overwrite_word(const std::string& ring, LongwordOffset offset, std::uint32_t value) {
  const auto object = broker::SharedObject::open(ring);
  const auto mapping = object.map(0, object.size());
  const auto* const header = reinterpret_cast<const broker::Header*>(mapping.address());
  std::memcpy(mapping.address() + header->memory_at + 4UL * offset.value(), &value, sizeof value);
}

}  // namespace rths::test

// SPDX-License-Identifier: Apache-2.0
//
// The second process of the bench.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/dds/gateway.hpp>

#include "samples.hpp"

namespace rths::bench {

/// A ring of the bench that is open to the network; removed at the end.
class OpenRing {
 public:
  OpenRing(const std::string& joint_name, const std::string& side, const memmap::Map& map,
           std::uint32_t domain);
  ~OpenRing();
  OpenRing(const OpenRing&) = delete;
  OpenRing& operator=(const OpenRing&) = delete;

  [[nodiscard]] broker::Ring& ring() { return ring_; }
  [[nodiscard]] dds::Gateway& gateway() { return *gateway_; }

 private:
  std::string name_;
  broker::Ring ring_;
  std::unique_ptr<dds::Gateway> gateway_;
};

/// Processor time of this process [s].
[[nodiscard]] double processor_time();
/// Waits for a condition. @throws Error if it is not true in time
void wait_for(const char* what, const std::function<bool()>& condition);

/// Answers the messages of the first process until its end.
void run_far_side(std::uint32_t domain);

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
//
// The second process of the bench, and its messages: bare DDS samples.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/dds/gateway.hpp>

namespace rths::bench {

/// A message between the two processes; as long as a frame with one update.
struct Message {
  enum Kind : std::uint64_t {
    kHere,    ///< answered at once
    kSample,  ///< counted, not answered
    kCount,   ///< answered when `number` samples have arrived
    kFollow,  ///< answered when the follower has seen the tag `number`
    kEcho,    ///< answers `number` writes through the ring
    kImage,   ///< opens the ring of 8 MiB to the network until its image is here
    kRest,    ///< answered after `number` ms, with the processor time used
    kEnd
  };
  std::uint64_t kind = kHere;
  std::uint64_t number = 0;
  std::uint64_t lost = 0, reordered = 0;
  double seconds = 0;
  std::uint64_t padding[3] = {};
};
static_assert(sizeof(Message) == 64);

/// Samples of the two processes.
class Samples {
 public:
  explicit Samples(std::uint32_t domain);
  void send(const Message& message);
  /// Sends bytes without a meaning, which count as a sample.
  void send_bytes(std::size_t bytes);
  /// @throws Error if there is none in time
  [[nodiscard]] Message receive();

 private:
  std::unique_ptr<dds::Carrier> carrier_;
  std::vector<std::byte> buffer_;
};

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

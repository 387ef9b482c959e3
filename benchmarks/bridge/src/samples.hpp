// SPDX-License-Identifier: Apache-2.0
//
// Bare DDS samples between the two processes of the bench, without the gateway.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

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

/// One writer and one reader, reliable, received with a wait set.
class Samples {
 public:
  /// @throws Error if DDS cannot start
  explicit Samples(std::uint32_t domain);
  ~Samples();
  Samples(const Samples&) = delete;
  Samples& operator=(const Samples&) = delete;

  void send(const Message& message);
  /// Sends bytes without a meaning, which count as a sample.
  void send_bytes(std::size_t bytes);
  /// @throws Error if there is none in time
  [[nodiscard]] Message receive();

 private:
  struct Entities;
  std::unique_ptr<Entities> entities_;
};

}  // namespace rths::bench

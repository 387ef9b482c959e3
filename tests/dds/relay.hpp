// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <vector>

#include <rths/dds/carrier.hpp>

namespace rths::test {

/// Faults of a relay: shares of the frames, and the longest delay.
struct RelayFaults {
  double loss = 0, duplication = 0, reordering = 0;
  Duration jitter{0};
};
struct RelayCounts {
  std::uint64_t passed = 0, lost = 0, duplicated = 0, delayed = 0;
  std::size_t carriers = 0;
};

/// Carries frames between gateways of this process, with faults drawn from a seed.
class Relay : public std::enable_shared_from_this<Relay> {
 public:
  explicit Relay(std::uint64_t seed, const RelayFaults& faults = {})
      : random_{seed}, faults_{faults} {}
  /// A carrier that is connected to all others of this relay.
  [[nodiscard]] std::unique_ptr<dds::Carrier> connect();
  /// Spoils a carrier's records of the others: nothing arrives at it, or nothing that it sends
  /// arrives, until it joins anew.
  enum class Way : std::uint8_t { In, Out };
  void spoil(std::size_t carrier, Way way);
  /// Cuts a carrier off, by the order of connection, or connects it again.
  void cut(std::size_t carrier, bool off);
  void set_faults(const RelayFaults& faults);
  [[nodiscard]] RelayCounts counts() const;
  /// Puts bytes on the way to all, as a hostile participant does.
  void inject(const std::vector<std::byte>& bytes);

 private:
  class Port;
  using Queue = std::multimap<TimePoint, std::vector<std::byte>>;
  void send(std::size_t from, std::span<const std::byte> bytes);
  [[nodiscard]] std::vector<dds::PresentHost> present(std::size_t at) const;
  void rejoin(std::size_t at);
  [[nodiscard]] bool receive(std::size_t at, std::vector<std::byte>& bytes, Duration timeout);
  void deliver(Queue& queue, std::span<const std::byte> bytes);

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::mt19937_64 random_;
  RelayFaults faults_;
  RelayCounts counts_;
  std::vector<Queue> queues_;
  std::vector<bool> cut_, spoilt_in_, spoilt_out_;
  std::vector<std::uint64_t> ids_;
};

}  // namespace rths::test

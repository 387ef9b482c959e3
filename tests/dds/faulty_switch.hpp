// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace rths::test {

/// Faults of a switch: shares of the datagrams, and hosts.
struct SwitchFaults {
  double garbling = 0;  ///< one to four bits each; the checksum of UDP stays valid
  double loss = 0, duplication = 0, reordering = 0;
  std::set<int> cut = {};              ///< hosts, from 1 on
  std::set<int> deaf = {};             ///< hosts that send, but receive nothing
  std::set<std::set<int>> apart = {};  ///< pairs of hosts that do not receive each other
};

/// An Ethernet switch that damages datagrams. Its thread carries packets between the ports of a
/// Network without a switch.
class FaultySwitch {
 public:
  /// @param ports  namespace with "port1", "port2", …
  FaultySwitch(const std::string& ports, int hosts, std::uint64_t seed);
  ~FaultySwitch();
  FaultySwitch(const FaultySwitch&) = delete;
  FaultySwitch& operator=(const FaultySwitch&) = delete;

  /// False if packet sockets are not permitted.
  [[nodiscard]] bool works() const { return works_; }
  void set(const SwitchFaults& faults);
  /// Number of datagrams that were changed.
  [[nodiscard]] std::uint64_t garbled() const { return garbled_; }

 private:
  using Packet = std::vector<std::uint8_t>;
  void open(const std::string& ports, int hosts);
  void run();
  void carry(std::size_t from, Packet packet);
  void damage(Packet& packet);
  void deliver(std::size_t from, const Packet& packet) const;
  [[nodiscard]] bool passes(int from, int to) const;
  [[nodiscard]] bool draw(double share);

  std::vector<int> sockets_;  ///< by host
  bool works_ = false;
  std::mutex mutex_;  ///< of the faults
  SwitchFaults faults_;
  std::mt19937_64 random_;
  std::pair<std::size_t, Packet> overtaken_;  ///< a packet that waits for the next one
  std::atomic<std::uint64_t> garbled_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace rths::test

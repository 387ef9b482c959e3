// SPDX-License-Identifier: Apache-2.0
#include <rths/dds/network.hpp>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <array>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

#include "clock_offset.hpp"
#include "frame.hpp"
#include "hello.hpp"

namespace rths::dds {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{50};
constexpr const char* kAnyRing = "*";
constexpr HostId kVisitor = 1;  // ids of gateways are random and large
constexpr std::size_t kMostGateways = 64;

/// The gateways found so far. A thread of the carrier adds them.
class FoundGateways {
 public:
  void add(std::span<const std::byte> bytes) {
    FrameDefect defect{};
    const auto frame = decode(bytes, defect);
    if (!frame || frame->header.kind != FrameKind::Hello || frame->header.map_hash == 0) return;
    const auto hello = hello_from(frame->payload);
    if (!hello) return;
    const TimePoint now = WallClock{}.now(), sent{frame->header.sent};
    const std::lock_guard lock{mutex_};
    if (gateways_.size() == kMostGateways && gateways_.count(frame->header.host) == 0) return;
    Gateway& gateway = gateways_[frame->header.host];
    gateway.sent = sent;
    gateway.found.host.name = hello->host;
    gateway.found.map_hash = frame->header.map_hash;
    gateway.found.nodes = hello->nodes.size();
    gateway.received = now;
    gateway.real_time = hello->real_time;
    for (const auto& echo : hello->echoes)
      if (echo.host == kVisitor) gateway.clock.add(echo.sent, echo.received, sent, now);
  }
  [[nodiscard]] std::vector<FoundGateway> all() {
    const std::lock_guard lock{mutex_};
    const TimePoint now = WallClock{}.now();
    std::vector<FoundGateway> result;
    for (auto& [id, gateway] : gateways_) {
      RemoteHost& host = gateway.found.host;
      host.silence = now - gateway.received;
      if (const auto clock = gateway.clock.at(now)) {
        host.clock = {clock->offset, clock->error};
        host.real_time_ahead = gateway.real_time + clock->offset - real_time_offset();
      }
      result.push_back(gateway.found);
    }
    return result;
  }

 private:
  struct Gateway {
    FoundGateway found;
    TimePoint sent{0}, received{0};
    Duration real_time{0};
    ClockOffset clock;
  };
  std::mutex mutex_;
  std::map<HostId, Gateway> gateways_;
};

// An announcement without a map: gateways only note its time.
std::vector<std::byte> greeting() {
  FrameHeader header;
  header.kind = FrameKind::Hello;
  header.host = kVisitor;
  header.sent = WallClock{}.now().count();
  FrameWriter frame{header};
  Hello hello;
  hello.host = "visitor";
  hello.real_time = real_time_offset();
  frame.add_bytes(to_bytes(hello));
  return frame.finish();
}

int mtu_of(const std::string& interface) {
  int mtu = 0;
  std::ifstream{"/sys/class/net/" + interface + "/mtu"} >> mtu;
  return mtu;
}

}  // namespace

std::vector<Interface> interfaces() {
  std::vector<Interface> result;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return result;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
    inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
    result.push_back({entry->ifa_name, text.data(), mtu_of(entry->ifa_name),
                      (entry->ifa_flags & IFF_UP) != 0, (entry->ifa_flags & IFF_MULTICAST) != 0});
  }
  freeifaddrs(first);
  return result;
}

std::vector<FoundGateway> listen_for_gateways(CycloneOptions network, Duration listening) {
  network.ring = kAnyRing;
  const auto carrier = make_cyclone_carrier(network);
  FoundGateways found;
  carrier->listen([&](std::span<const std::byte> bytes) { found.add(bytes); });
  const WallClock clock;
  const TimePoint end = clock.now() + listening;
  while (clock.now() < end) {
    static_cast<void>(carrier->send(greeting()));
    std::this_thread::sleep_for(kPeriod);
  }
  carrier->listen({});
  return found.all();
}

}  // namespace rths::dds

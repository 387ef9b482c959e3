// SPDX-License-Identifier: Apache-2.0
#include <rths/dds/network.hpp>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "clock_offset.hpp"
#include "frame.hpp"
#include "hello.hpp"

namespace rths::dds {
namespace {

constexpr Duration kGreetingPeriod = std::chrono::milliseconds{50};
constexpr Duration kQuiet = std::chrono::milliseconds{500};  // several announcements
constexpr Duration kFirstContact = std::chrono::seconds{1};
constexpr const char* kAnyRing = "*";
constexpr std::size_t kMostGateways = 64;

/// A gateway, with its last announcement.
struct Announcer {
  std::uint64_t map_hash = 0;
  Hello hello;
  TimePoint sent{0}, first{0}, received{0};
  ClockOffset clock;
};
using Gateways = std::map<HostId, Announcer>;

/// The gateways found so far. A thread of the carrier adds them.
class FoundGateways {
 public:
  /// @param visitor  id of this program in the answers of gateways
  explicit FoundGateways(HostId visitor) : visitor_{visitor} {}
  void add(std::span<const std::byte> bytes) {
    FrameDefect defect{};
    const auto frame = decode(bytes, defect);
    if (!frame || frame->header.kind != FrameKind::Hello || frame->header.map_hash == 0) return;
    auto hello = hello_from(frame->payload);
    if (!hello) return;
    const TimePoint now = WallClock{}.now(), sent{frame->header.sent};
    const std::lock_guard lock{mutex_};
    if (gateways_.size() == kMostGateways && gateways_.count(frame->header.host) == 0) return;
    Announcer& gateway = gateways_[frame->header.host];
    if (gateway.first == TimePoint{0}) gateway.first = now;
    gateway.sent = sent;
    gateway.received = now;
    gateway.map_hash = frame->header.map_hash;
    for (const auto& echo : hello->echoes)
      if (echo.host == visitor_) gateway.clock.add(echo.sent, echo.received, sent, now);
    gateway.hello = std::move(*hello);
  }
  [[nodiscard]] Gateways all() {
    const std::lock_guard lock{mutex_};
    return gateways_;
  }

 private:
  HostId visitor_;
  std::mutex mutex_;
  Gateways gateways_;
};

/// What a domain lacks, from the announcements of its gateways and the network's own.
class Examination {
 public:
  Examination(const Gateways& gateways, std::map<HostId, std::string> rings, TimePoint now)
      : gateways_{gateways}, rings_{std::move(rings)}, now_{now} {}
  [[nodiscard]] std::vector<std::string> faults() {
    for (const auto& [id, gateway] : gateways_) {
      if (is_silent(gateway)) add_silent(gateway);
      if (!takes_part(gateway)) continue;
      if (!gateway.clock.at(now_))
        faults_.push_back(fmt::format("host '{}' does not receive this host", gateway.hello.host));
      for (auto other = gateways_.upper_bound(id); other != gateways_.end(); ++other)
        if (is_same_ring(id, other->first) && takes_part(other->second))
          compare(id, gateway, other->first, other->second);
      for (const auto& missed : gateway.hello.missed) add_missed(gateway, missed);
    }
    return std::move(faults_);
  }

 private:
  [[nodiscard]] bool is_silent(const Announcer& gateway) const {
    return now_ - gateway.received > kQuiet;
  }
  // Others need a moment to notice a new gateway.
  [[nodiscard]] bool takes_part(const Announcer& gateway) const {
    return !is_silent(gateway) && !gateway.hello.is_last && now_ - gateway.first > kQuiet;
  }
  [[nodiscard]] bool is_same_ring(HostId one, HostId other) const {
    const auto its = rings_.find(one), others = rings_.find(other);
    return its != rings_.end() && others != rings_.end() && its->second == others->second;
  }
  [[nodiscard]] bool has(const std::string& host) const {
    return std::any_of(gateways_.begin(), gateways_.end(), [&](const auto& one) {
      return one.second.hello.host == host && !is_silent(one.second);
    });
  }
  void add_silent(const Announcer& gateway) {
    if (gateway.hello.is_last || has(gateway.hello.host)) return;
    faults_.push_back(fmt::format("host '{}' is silent since {:.1f} s", gateway.hello.host,
                                  to_seconds(now_ - gateway.received)));
  }
  void add_missed(const Announcer& gateway, const Missed& missed) {
    if (has(missed.host)) return;
    faults_.push_back(fmt::format("host '{}' has received nothing of host '{}' for {:.1f} s",
                                  gateway.hello.host, missed.host, to_seconds(missed.silence)));
  }
  static bool receives(const Announcer& gateway, HostId other) {
    return std::any_of(gateway.hello.echoes.begin(), gateway.hello.echoes.end(),
                       [&](const auto& echo) { return echo.host == other; });
  }
  void compare(HostId id, const Announcer& gateway, HostId other_id, const Announcer& other) {
    const auto &name = gateway.hello.host, &other_name = other.hello.host;
    const bool forth = receives(gateway, other_id), back = receives(other, id);
    if (gateway.map_hash != other.map_hash)
      faults_.push_back(
          fmt::format("hosts '{}' and '{}' have different maps of one ring", name, other_name));
    else if (!forth && !back)
      faults_.push_back(
          fmt::format("hosts '{}' and '{}' do not receive each other", name, other_name));
    else if (!forth || !back)
      faults_.push_back(fmt::format("host '{}' does not receive host '{}'",
                                    forth ? other_name : name, forth ? name : other_name));
  }

  const Gateways& gateways_;
  std::map<HostId, std::string> rings_;
  TimePoint now_;
  std::vector<std::string> faults_;
};

// An announcement without a map: gateways only note its time.
std::vector<std::byte> greeting(HostId visitor) {
  FrameHeader header;
  header.kind = FrameKind::Hello;
  header.host = visitor;
  header.sent = WallClock{}.now().count();
  FrameWriter frame{header};
  Hello hello;
  hello.host = "visitor";
  hello.real_time = real_time_offset();
  frame.add_bytes(to_bytes(hello));
  return frame.finish();
}

FoundGateway found(const Announcer& gateway, TimePoint now) {
  FoundGateway found{{gateway.hello.host, now - gateway.received, {}, {}},
                     gateway.map_hash,
                     gateway.hello.nodes.size()};
  if (const auto clock = gateway.clock.at(now)) {
    found.host.clock = {clock->offset, clock->error};
    found.host.real_time_ahead = gateway.hello.real_time + clock->offset - real_time_offset();
  }
  return found;
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

namespace {

/// Listens to a domain.
class Listener {
 public:
  explicit Listener(const CycloneOptions& network) : carrier_{make_cyclone_carrier(network)} {
    carrier_->listen([this](std::span<const std::byte> bytes) { gateways_.add(bytes); });
  }
  ~Listener() { carrier_->listen({}); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  /// A number of looks, so that a busy host does not shorten it.
  void listen(Duration duration) {
    for (auto looks = duration / kGreetingPeriod; looks > 0; --looks) {
      static_cast<void>(carrier_->send(greeting(carrier_->id())));
      std::this_thread::sleep_for(kGreetingPeriod);
      for (const auto& host : carrier_->present()) since_.try_emplace(host.id, clock_.now());
    }
  }
  [[nodiscard]] FoundDomain domain() {
    const auto present = carrier_->present();
    const TimePoint now = clock_.now();
    const Gateways all = gateways_.all();
    std::map<HostId, std::string> rings;
    FoundDomain domain;
    for (const auto& host : present) {
      rings[host.id] = host.ring;
      if (!all.contains(host.id) && now - since_[host.id] > kFirstContact)
        domain.faults.push_back(fmt::format(
            "host '{}' is on the network, but none of its frames arrive", printable(host.host)));
    }
    for (const auto& [id, gateway] : all) domain.gateways.push_back(found(gateway, now));
    for (auto& fault : Examination{all, rings, now}.faults())
      domain.faults.push_back(std::move(fault));
    return domain;
  }

 private:
  WallClock clock_;
  std::unique_ptr<Carrier> carrier_;
  FoundGateways gateways_{carrier_->id()};
  std::map<HostId, TimePoint> since_;  ///< hosts that the network announces
};

}  // namespace

FoundDomain listen_for_gateways(CycloneOptions network, Duration listening) {
  network.ring = kAnyRing;
  Listener listener{network};
  listener.listen(listening);
  const auto domain = listener.domain();
  if (!domain.gateways.empty() && domain.faults.empty()) return domain;
  // Announcements may have been late, on a busy host.
  listener.listen(listening);
  return listener.domain();
}

}  // namespace rths::dds

// SPDX-License-Identifier: Apache-2.0
#include "faulty_switch.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace rths::test {
namespace {

constexpr std::size_t kEthernet = 14;  // length of its header [B]
constexpr std::uint8_t kUdp = 17;

// A socket of all packets of an interface.
int packets_of(const std::string& interface) {
  const int socket = ::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  const int buffer = 8 << 20;
  setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  if (address.sll_ifindex == 0 ||
      bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return -1;
  return socket;
}

bool is_datagram(const std::vector<std::uint8_t>& packet) {
  return packet.size() > kEthernet + 28 && packet[12] == 8 && packet[13] == 0 &&
         packet[kEthernet + 9] == kUdp;
}

std::size_t length_of_ip_header(const std::vector<std::uint8_t>& packet) {
  return 4UL * (packet[kEthernet] & 15U);
}

bool is_first_fragment(const std::vector<std::uint8_t>& packet) {
  return (packet[kEthernet + 6] & 0x1FU) == 0 && packet[kEthernet + 7] == 0;
}

}  // namespace

FaultySwitch::FaultySwitch(const std::string& ports, int hosts, std::uint64_t seed)
    : random_{seed} {
  // A thread of its own, as it moves to the other namespace.
  std::thread{[&] { open(ports, hosts); }}.join();
  if (works_) thread_ = std::thread{[this] { run(); }};
}

FaultySwitch::~FaultySwitch() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  for (const int socket : sockets_) close(socket);
}

void FaultySwitch::open(const std::string& ports, int hosts) {
  const int network = ::open(ports.c_str(), O_RDONLY | O_CLOEXEC);
  works_ = network >= 0 && setns(network, CLONE_NEWNET) == 0;
  close(network);
  for (int host = 1; works_ && host <= hosts; ++host) {
    sockets_.push_back(packets_of("port" + std::to_string(host)));
    works_ = sockets_.back() >= 0;
  }
}

void FaultySwitch::set(const SwitchFaults& faults) {
  const std::lock_guard lock{mutex_};
  faults_ = faults;
}

void FaultySwitch::run() {
  std::vector<pollfd> ready;
  for (const int socket : sockets_) ready.push_back({socket, POLLIN, 0});
  std::array<std::uint8_t, 65536> buffer{};
  while (!ends_) {
    if (poll(ready.data(), ready.size(), 20) <= 0) continue;
    for (std::size_t host = 0; host < sockets_.size(); ++host) {
      if (ready[host].revents == 0) continue;
      sockaddr_ll from{};
      socklen_t size = sizeof from;
      const auto length = recvfrom(sockets_[host], buffer.data(), buffer.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&from), &size);
      if (length <= 0 || from.sll_pkttype == PACKET_OUTGOING) continue;
      carry(host, {buffer.begin(), buffer.begin() + length});
    }
  }
}

bool FaultySwitch::draw(double share) {
  return std::uniform_real_distribution<double>{0, 1}(random_) < share;
}

void FaultySwitch::carry(std::size_t from, Packet packet) {
  const std::lock_guard lock{mutex_};
  if (!is_datagram(packet)) return deliver(from, packet);
  // The kernel leaves the checksum to the network card; zero stands for none.
  const std::size_t udp = kEthernet + length_of_ip_header(packet);
  if (is_first_fragment(packet)) packet[udp + 6] = packet[udp + 7] = 0;
  if (draw(faults_.loss)) return;
  if (draw(faults_.garbling)) damage(packet);
  if (overtaken_.second.empty() && draw(faults_.reordering)) {
    overtaken_ = {from, std::move(packet)};
    return;
  }
  deliver(from, packet);
  if (draw(faults_.duplication)) deliver(from, packet);
  if (!overtaken_.second.empty()) deliver(overtaken_.first, std::exchange(overtaken_.second, {}));
}

void FaultySwitch::damage(Packet& packet) {
  const std::size_t payload = kEthernet + length_of_ip_header(packet) + 8;
  if (packet.size() <= payload) return;
  const auto bits = 1 + random_() % 4;
  for (std::uint64_t i = 0; i < bits; ++i)
    packet[payload + random_() % (packet.size() - payload)] ^=
        static_cast<std::uint8_t>(1U << (random_() % 8));
  ++garbled_;
}

bool FaultySwitch::passes(int from, int to) const {
  return from != to && !faults_.cut.contains(from) && !faults_.cut.contains(to) &&
         !faults_.deaf.contains(to) && !faults_.apart.contains({from, to});
}

// All packets go to all other hosts: there are few.
void FaultySwitch::deliver(std::size_t from, const Packet& packet) const {
  for (std::size_t to = 0; to < sockets_.size(); ++to)
    if (passes(static_cast<int>(from) + 1, static_cast<int>(to) + 1))
      static_cast<void>(write(sockets_[to], packet.data(), packet.size()));
}

}  // namespace rths::test

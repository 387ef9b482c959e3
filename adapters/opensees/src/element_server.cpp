// SPDX-License-Identifier: Apache-2.0
#include "opensees_connection.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

#include "process_table.hpp"

namespace rths::adapters {
namespace {

namespace fs = std::filesystem;

/// A socket of this host, as /proc/net lists it.
struct LocalSocket {
  unsigned user = 0;
  std::string inode;
};

std::string in_hex(const sockaddr_in& address) {
  return fmt::format("{:08X}:{:04X}", address.sin_addr.s_addr, ntohs(address.sin_port));
}

std::string in_text(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return text.data();
}

// A socket of IPv6 that talks IPv4 has a mapped address, ::ffff:a.b.c.d.
std::string without_mapping(const std::string& address) {
  constexpr std::string_view kMapped = "0000000000000000FFFF0000",
                             kAny6 = "000000000000000000000000";
  if (address.starts_with(kMapped) || address.starts_with(kAny6))
    return address.substr(kMapped.size());
  return address;
}

std::string port_in_hex(const std::string& address) { return address.substr(address.find(':')); }

/// The two ends of a connection, as /proc/net has them.
struct Ends {
  Ends(const sockaddr_in& of_peer, const sockaddr_in& ours)
      : peer{in_hex(of_peer)},
        any_peer{fmt::format("00000000:{:04X}", ntohs(of_peer.sin_port))},
        own{in_hex(ours)} {}
  std::string peer, any_peer, own;
};

// The socket of a line of /proc/net if it owns the peer's end. A datagram socket need not be bound
// to an address or connected.
std::optional<LocalSocket> socket_in(const std::string& line, const Ends& ends, bool is_udp) {
  std::istringstream words{line};
  std::string slot, local, remote, state, queues, timer, retries, timeout;
  LocalSocket socket;
  words >> slot >> local >> remote >> state >> queues >> timer >> retries >> socket.user >>
      timeout >> socket.inode;
  if (!words || socket.inode == "0") return std::nullopt;
  local = without_mapping(local);
  remote = without_mapping(remote);
  const bool is_peer = local == ends.peer || (is_udp && local == ends.any_peer);
  const bool is_ours =
      is_udp ? port_in_hex(remote) == port_in_hex(ends.own) || remote == "00000000:0000"
             : remote == ends.own;
  return is_peer && is_ours ? std::optional{socket} : std::nullopt;
}

// Sockets of this host that own the peer's end.
std::vector<LocalSocket> sockets_of(Transport transport, const sockaddr_in& peer,
                                    const sockaddr_in& own) {
  const Ends ends{peer, own};
  const bool is_udp = transport == Transport::Udp;
  std::vector<LocalSocket> found;
  for (const char* version : {"", "6"}) {
    std::ifstream table{fmt::format("/proc/net/{}{}", is_udp ? "udp" : "tcp", version)};
    std::string line;
    std::getline(table, line);  // heading
    while (std::getline(table, line))
      if (auto socket = socket_in(line, ends, is_udp)) found.push_back(std::move(*socket));
  }
  return found;
}

bool holds(int pid, const std::string& inode) {
  std::error_code ended;
  for (const auto& entry : fs::directory_iterator{fmt::format("/proc/{}/fd", pid), ended})
    if (fs::read_symlink(entry.path(), ended).string() == fmt::format("socket:[{}]", inode))
      return true;
  return false;
}

// The processes that have the socket open, as far as this process may see them.
std::vector<int> holders(const std::string& inode, const std::map<int, Process>& all) {
  std::vector<int> pids;
  for (const auto& [pid, process] : all)
    if (holds(pid, inode)) pids.push_back(pid);
  return pids;
}

std::string described(const LocalSocket& socket, const std::vector<int>& pids,
                      const std::map<int, Process>& all) {
  if (pids.empty()) return fmt::format("a process of user {}", socket.user);
  return fmt::format("process {} ({}) of user {}", pids[0], all.at(pids[0]).name, socket.user);
}

std::optional<std::string> refusal_of(const LocalSocket& socket, int expected) {
  if (expected == 0 && socket.user == geteuid()) return std::nullopt;
  const auto all = processes();
  const auto pids = holders(socket.inode, all);
  if (expected == 0)
    return fmt::format("{}, expected a process of user {}", described(socket, pids, all),
                       geteuid());
  const auto is_expected = [&](int pid) { return descends_from(pid, expected, all); };
  // Another process that shares the socket could write to it too.
  if (!pids.empty() && std::all_of(pids.begin(), pids.end(), is_expected)) return std::nullopt;
  return fmt::format("{}, expected process {}, which this run started",
                     described(socket, pids, all), expected);
}

constexpr int kMostReported = 10;  // refused peers
constexpr int kMostAtOnce = 1000;  // messages: OpenSees sends far fewer between requests

}  // namespace

ElementServer::ElementServer(const OpenSeesElement& element)
    : name_{fmt::format("element '{}'", element.name)},
      is_udp_{element.is_udp},
      endpoint_{element.is_udp ? Transport::Udp : Transport::Tcp, element.address, element.port},
      client_{name_, element.dofs()} {
  if (!element.address.starts_with("127."))
    write_message(fmt::format("{}: warning: port {} of {} can be reached from other hosts\n", name_,
                              element.port, element.address));
}

void ElementServer::admit(const Admission& admission) {
  const Transport transport = is_udp_ ? Transport::Udp : Transport::Tcp;
  endpoint_.set_gate([admission, transport, name = name_, refused = 0](
                         const sockaddr_in& peer, const sockaddr_in& own) mutable {
    const auto reason = refusal(admission, transport, peer, own);
    if (!reason) return true;
    if (++refused <= kMostReported)
      write_message(
          fmt::format("{}: refused {}{}\n", name, *reason,
                      refused == kMostReported ? "; further refusals are not reported" : ""));
    return false;
  });
}

bool ElementServer::receive() {
  int received = 0;
  just_connected_ = false;
  try {
    for (;
         received < kMostAtOnce && !disconnected_ && !measurement_requested_ && !matrix_requested_;
         ++received) {
      const auto message = endpoint_.receive(client_.expected());
      if (message.empty()) break;
      handle(message);
    }
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error{message.starts_with(name_) ? message : fmt::format("{}: {}", name_, message)};
  }
  return received > 0;
}

void ElementServer::handle(std::span<const std::byte> message) {
  switch (client_.receive(message)) {
    case GenericClient::Message::Trial:
      ++trials_;
      // A repeated trial does not cancel a pending move.
      is_new_ = is_new_ || client_.is_new();
      break;
    case GenericClient::Message::MeasurementRequest:
      measurement_requested_ = true;
      break;
    case GenericClient::Message::MatrixRequest:
      matrix_requested_ = true;
      break;
    case GenericClient::Message::End:
      disconnected_ = true;
      break;
    case GenericClient::Message::Sizes:
      connected_ = just_connected_ = true;
      break;
    case GenericClient::Message::Commit:
      break;
  }
}

void ElementServer::answer(const Measurement& measured) {
  measurement_requested_ = false;
  endpoint_.send(client_.measured_reply(measured), kSendDeadline);
}

void ElementServer::answer(const ElementMatrices& matrices) {
  matrix_requested_ = false;
  endpoint_.send(client_.matrix_reply(matrices), kSendDeadline);
}

std::optional<std::string> refusal(const Admission& admission, Transport transport,
                                   const sockaddr_in& peer, const sockaddr_in& own) {
  if (admission.address == "any") return std::nullopt;
  const std::string address = in_text(peer);
  if (!admission.address.empty()) {
    if (address == admission.address) return std::nullopt;
    return fmt::format("{}, expected {}", address, admission.address);
  }
  const auto sockets = sockets_of(transport, peer, own);
  if (sockets.empty())
    return fmt::format("{} port {}, expected a process of this host", address,
                       ntohs(peer.sin_port));
  for (const auto& socket : sockets)
    if (auto reason = refusal_of(socket, admission.process)) return reason;
  return std::nullopt;
}

}  // namespace rths::adapters

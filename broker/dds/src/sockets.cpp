// SPDX-License-Identifier: Apache-2.0
#include "sockets.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include <rths/dds/network.hpp>

namespace rths::dds {
namespace {

// The local address of an IPv4 UDP socket; empty for anything else.
std::optional<in_addr> address_of(int socket) {
  int type = 0;
  socklen_t size = sizeof type;
  if (getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM)
    return std::nullopt;
  sockaddr_in address{};
  size = sizeof address;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      address.sin_family != AF_INET)
    return std::nullopt;
  return address.sin_addr;
}

std::string text_of(in_addr address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), text.size());
  return text.data();
}

// The interface that has an address; a further address of an interface may have a label, "eth0:1".
std::string interface_with(const std::string& address) {
  for (const auto& interface : interfaces())
    if (interface.address == address) return interface.name.substr(0, interface.name.find(':'));
  return "";
}

}  // namespace

std::set<int> udp_sockets() {
  std::set<int> sockets;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/fd", error}) {
    const std::string name = entry.path().filename();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (address_of(descriptor)) sockets.insert(descriptor);
  }
  return sockets;
}

std::string bind_new_sockets(const std::set<int>& before) {
  std::set<int> made;
  std::set<std::string> addresses;
  for (const int socket : udp_sockets())
    if (const auto address = address_of(socket); address && !before.contains(socket)) {
      made.insert(socket);
      fcntl(socket, F_SETFD, FD_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
      if (address->s_addr != INADDR_ANY) addresses.insert(text_of(*address));
    }
  if (addresses.size() != 1) return "";
  const std::string interface = interface_with(*addresses.begin());
  for (const int socket : made)
    if (setsockopt(socket, SOL_SOCKET, SO_BINDTODEVICE, interface.data(),
                   static_cast<socklen_t>(interface.size())) != 0)
      return fmt::format("sockets cannot be bound to interface '{}': {}", interface,
                         std::strerror(errno));
  return "";
}

}  // namespace rths::dds

// SPDX-License-Identifier: Apache-2.0
#include "socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

constexpr timeval kSocketTimeout{10, 0};

[[noreturn]] void fail(const char* problem) {
  throw Error{fmt::format("{}: {}", problem, std::strerror(errno))};
}

sockaddr_in address_of(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

// An address as the system calls expect it.
struct Address {
  sockaddr_in in;
  [[nodiscard]] sockaddr* get() { return reinterpret_cast<sockaddr*>(&in); }
};

int open(Transport transport) {
  const int fd =
      socket(AF_INET, (transport == Transport::Tcp ? SOCK_STREAM : SOCK_DGRAM) | SOCK_CLOEXEC, 0);
  if (fd < 0) fail("cannot create a socket");
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &kSocketTimeout, sizeof kSocketTimeout);
  setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &kSocketTimeout, sizeof kSocketTimeout);
  return fd;
}

}  // namespace

Socket::~Socket() {
  if (fd_ >= 0) close(fd_);
}

void Socket::send(std::span<const std::byte> message) const {
  while (!message.empty()) {
    const ssize_t sent = ::send(fd_, message.data(), message.size(), MSG_NOSIGNAL);
    if (sent <= 0) fail("cannot send");
    message = message.subspan(static_cast<std::size_t>(sent));
  }
}

void Socket::receive(std::span<std::byte> message) const {
  while (!message.empty()) {
    const ssize_t got = recv(fd_, message.data(), message.size(), 0);
    if (got <= 0) fail("no answer");
    message = message.subspan(static_cast<std::size_t>(got));
  }
}

Socket connect_to(Transport transport, std::uint16_t port, std::chrono::seconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  Address address{address_of(port)};
  for (;;) {
    Socket socket{open(transport)};
    bool is_connected = connect(socket.get(), address.get(), sizeof address.in) == 0;
    if (is_connected && transport == Transport::Udp) {
      const char hello = 'a';
      char answer = 0;
      constexpr timeval kShort{0, 200'000};
      setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &kShort, sizeof kShort);
      is_connected =
          ::send(socket.get(), &hello, 1, 0) == 1 && recv(socket.get(), &answer, 1, 0) == 1;
      setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &kSocketTimeout, sizeof kSocketTimeout);
    }
    if (is_connected) return socket;
    if (std::chrono::steady_clock::now() > deadline) fail("cannot connect");
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
}

Socket serve(Transport transport, std::uint16_t port) {
  Socket socket{open(transport)};
  Address address{address_of(port)};
  if (bind(socket.get(), address.get(), sizeof address.in) != 0) fail("cannot bind a port");
  if (transport == Transport::Tcp && listen(socket.get(), 1) != 0) fail("cannot listen");
  return socket;
}

std::uint16_t free_port() {
  const Socket probe = serve(Transport::Tcp, 0);
  Address address{};
  socklen_t size = sizeof address.in;
  if (getsockname(probe.get(), address.get(), &size) != 0) fail("cannot read the port");
  return ntohs(address.in.sin_port);
}

}  // namespace rths::bench

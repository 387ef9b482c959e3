// SPDX-License-Identifier: Apache-2.0
#include "ping_pong.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

constexpr std::chrono::seconds kPatience{5};

// Sent at once, not when there is more.
void hurry(const Socket& socket) {
  const int yes = 1;
  setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

// From its first letter on a socket of UDP belongs to that client.
Socket accepted(Transport transport, const Socket& served) {
  const char* const late = "the ping-pong's client does not come";
  sockaddr_in from{};
  socklen_t size = sizeof from;
  auto* const address = static_cast<sockaddr*>(static_cast<void*>(&from));
  if (transport == Transport::Tcp) {
    Socket socket{accept4(served.get(), address, &size, SOCK_CLOEXEC)};
    if (socket.get() < 0) throw Error{late};
    hurry(socket);
    return socket;
  }
  char hello = 0;
  if (recvfrom(served.get(), &hello, 1, 0, address, &size) != 1 ||
      connect(served.get(), address, size) != 0 || send(served.get(), "b", 1, 0) != 1)
    throw Error{late};
  return Socket{dup(served.get())};
}

// Until the client is gone, or this process killed.
void answer(Transport transport, const Socket& served, std::size_t length) {
  const Socket socket = accepted(transport, served);
  std::vector<std::byte> message(length);
  for (;;) {
    socket.receive(message);
    socket.send(message);
  }
}

Socket connected(Transport transport, std::uint16_t port) {
  Socket socket = connect_to(transport, port, kPatience);
  if (transport == Transport::Tcp) hurry(socket);
  return socket;
}

}  // namespace

PingPong::PingPong(Transport transport, std::size_t length, int cpu)
    : port_{free_port()},
      served_{serve(transport, port_)},
      partner_{cpu, [&] { answer(transport, served_, length); }},
      asking_{connected(transport, port_)} {}

void PingPong::exchange(std::span<std::byte> message) const {
  asking_.send(message);
  asking_.receive(message);
}

}  // namespace rths::bench

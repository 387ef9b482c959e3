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

constexpr std::chrono::seconds kTimeout{5};

// Sends every message at once, without waiting for more data.
void disable_nagle(const Socket& socket) {
  const int yes = 1;
  setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

// Accepts the client. A UDP socket connects to the sender of its first message.
Socket accepted(Transport transport, const Socket& server) {
  const char* const late = "the ping-pong's client did not connect";
  sockaddr_in from{};
  socklen_t size = sizeof from;
  auto* const address = reinterpret_cast<sockaddr*>(&from);
  if (transport == Transport::Tcp) {
    Socket socket{accept4(server.get(), address, &size, SOCK_CLOEXEC)};
    if (socket.get() < 0) throw Error{late};
    disable_nagle(socket);
    return socket;
  }
  char hello = 0;
  if (recvfrom(server.get(), &hello, 1, 0, address, &size) != 1 ||
      connect(server.get(), address, size) != 0 || send(server.get(), "b", 1, 0) != 1)
    throw Error{late};
  return Socket{dup(server.get())};
}

// Runs until the client disconnects or this process is killed.
void answer(Transport transport, const Socket& server, std::size_t length) {
  const Socket socket = accepted(transport, server);
  std::vector<std::byte> message(length);
  for (;;) {
    socket.receive(message);
    socket.send(message);
  }
}

Socket connected(Transport transport, std::uint16_t port) {
  Socket socket = connect_to(transport, port, kTimeout);
  if (transport == Transport::Tcp) disable_nagle(socket);
  return socket;
}

}  // namespace

PingPong::PingPong(Transport transport, std::size_t length, int cpu)
    : port_{free_port()},
      server_{serve(transport, port_)},
      partner_{cpu, [&] { answer(transport, server_, length); }},
      client_{connected(transport, port_)} {}

void PingPong::exchange(std::span<std::byte> message) const {
  client_.send(message);
  client_.receive(message);
}

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#include "endpoint.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr std::size_t kDatagram = 9126;  // largest datagram of OpenSees [bytes]
constexpr int kConnectTimeout = 100;     // of a client [ms]
constexpr int kBacklog = 16;             // refused peers must not keep others out
constexpr char kHello = 'a', kWelcome = 'b';

[[noreturn]] void fail(const std::string& action) {
  throw Error{fmt::format("{}: {}", action, std::strerror(errno))};
}

void set(int fd, int level, int option) {
  const int on = 1;
  setsockopt(fd, level, option, &on, sizeof on);
}

int open_socket(Transport transport) {
  return socket(
      AF_INET,
      (transport == Transport::Tcp ? SOCK_STREAM : SOCK_DGRAM) | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

sockaddr_in socket_address(const std::string& address, std::uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &result.sin_addr) != 1)
    throw Error{
        fmt::format("'{}' is not an IPv4 address, expected for example 127.0.0.1", address)};
  return result;
}

bool becomes_ready(int fd, short events) {
  pollfd one{fd, events, 0};
  return poll(&one, 1, kConnectTimeout) == 1 && (one.revents & events) != 0;
}

sockaddr_in own_address(int fd) {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size);
  return own;
}

// If the port is closed, the system may assign it to the connecting socket itself.
bool is_connected_to_itself(int fd) {
  const sockaddr_in own = own_address(fd);
  sockaddr_in other{};
  socklen_t size = sizeof other;
  getpeername(fd, reinterpret_cast<sockaddr*>(&other), &size);
  return own.sin_port == other.sin_port && own.sin_addr.s_addr == other.sin_addr.s_addr;
}

// Length of the next datagram of a message.
std::size_t datagram_for(std::size_t missing) { return std::min(missing, kDatagram); }

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Descriptor::~Descriptor() {
  if (is_open()) close(fd_);
}

Endpoint::Endpoint(Transport transport, const std::string& address, std::uint16_t port)
    : transport_{transport}, listener_{open_socket(transport)} {
  const sockaddr_in own = socket_address(address, port);
  const std::string name = fmt::format("port {} of {}", port, address);
  if (!listener_.is_open()) fail(name);
  // The next test may start at once.
  if (transport == Transport::Tcp) set(listener_.get(), SOL_SOCKET, SO_REUSEADDR);
  if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) fail(name);
  if (transport == Transport::Tcp && ::listen(listener_.get(), kBacklog) != 0) fail(name);
}

std::optional<Endpoint> Endpoint::connect(Transport transport, const std::string& address,
                                          std::uint16_t port) {
  Endpoint end{transport};
  end.client_ = socket_address(address, port);
  const auto* const server = reinterpret_cast<const sockaddr*>(&end.client_);
  Descriptor socket{open_socket(transport)};
  if (!socket.is_open()) fail("no socket");
  if (transport == Transport::Udp) {
    char welcome = 0;
    if (sendto(socket.get(), &kHello, 1, 0, server, sizeof end.client_) != 1 ||
        !becomes_ready(socket.get(), POLLIN) || recv(socket.get(), &welcome, 1, 0) != 1 ||
        welcome != kWelcome)
      return std::nullopt;
    end.listener_ = std::move(socket);
  } else {
    if (::connect(socket.get(), server, sizeof end.client_) != 0 &&
        (errno != EINPROGRESS || !becomes_ready(socket.get(), POLLOUT)))
      return std::nullopt;
    int error = 0;
    socklen_t size = sizeof error;
    if (getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0 ||
        is_connected_to_itself(socket.get()))
      return std::nullopt;
    set(socket.get(), IPPROTO_TCP, TCP_NODELAY);
    end.connection_ = std::move(socket);
  }
  end.is_connected_ = true;
  return end;
}

void Endpoint::accept() {
  if (transport_ == Transport::Udp)
    accept_datagrams();
  else
    accept_stream();
}

// The kernel then drops datagrams of other senders.
void Endpoint::accept_datagrams() {
  char hello = 0;
  socklen_t size = sizeof client_;
  auto* const client = reinterpret_cast<sockaddr*>(&client_);
  const ssize_t count = recvfrom(listener_.get(), &hello, 1, MSG_TRUNC, client, &size);
  if (count != 1 || hello != kHello) return;
  if (gate_ && !gate_(client_, own_address(listener_.get()))) return;
  is_connected_ = ::connect(listener_.get(), client, sizeof client_) == 0 &&
                  ::send(listener_.get(), &kWelcome, 1, MSG_NOSIGNAL) == 1;
}

void Endpoint::accept_stream() {
  sockaddr_in peer{};
  socklen_t size = sizeof peer;
  Descriptor connection{accept4(listener_.get(), reinterpret_cast<sockaddr*>(&peer), &size,
                                SOCK_NONBLOCK | SOCK_CLOEXEC)};
  if (!connection.is_open()) return;
  if (gate_ && !gate_(peer, own_address(connection.get()))) return;
  connection_ = std::move(connection);
  listener_ = Descriptor{};  // an element has one peer
  set(connection_.get(), IPPROTO_TCP, TCP_NODELAY);
  is_connected_ = true;
}

std::size_t Endpoint::read_datagram(std::size_t length) {
  sockaddr_in sender{};
  socklen_t size = sizeof sender;
  const std::size_t expected = datagram_for(length - filled_);
  // MSG_TRUNC returns the full length of a datagram that is too long.
  const ssize_t count = recvfrom(listener_.get(), received_.data() + filled_, expected, MSG_TRUNC,
                                 reinterpret_cast<sockaddr*>(&sender), &size);
  if (count < 0) return 0;
  if (sender.sin_port != client_.sin_port || sender.sin_addr.s_addr != client_.sin_addr.s_addr)
    return 0;  // from another sender
  if (static_cast<std::size_t>(count) != expected)
    throw Error{fmt::format(
        "a datagram of {} bytes, expected {}: one was lost, or its sender is not OpenSees", count,
        expected)};
  return expected;
}

std::size_t Endpoint::read_some(std::size_t length) {
  if (transport_ == Transport::Udp) return read_datagram(length);
  const ssize_t count = recv(connection_.get(), received_.data() + filled_, length - filled_, 0);
  if (count < 0 && would_block()) return 0;
  if (count <= 0) throw Error{"the client closed the connection without code 99"};
  // OpenSees uses Nagle's algorithm, which delays each message until the previous one is
  // acknowledged. The system resets the option, so it is set after each read.
  set(connection_.get(), IPPROTO_TCP, TCP_QUICKACK);
  return static_cast<std::size_t>(count);
}

std::span<const std::byte> Endpoint::receive(std::size_t length) {
  if (is_delivered_) filled_ = 0, is_delivered_ = false;
  if (!is_connected_) accept();
  if (!is_connected_) return {};
  if (received_.size() < length) received_.resize(length);
  while (filled_ < length) {
    const std::size_t count = read_some(length);
    if (count == 0) return {};
    filled_ += count;
  }
  is_delivered_ = true;
  return std::span{received_}.first(length);
}

void Endpoint::send(std::span<const std::byte> message, Duration longest) {
  const TimePoint deadline = WallClock{}.now() + longest;
  while (!message.empty()) {
    const std::size_t expected =
        transport_ == Transport::Udp ? datagram_for(message.size()) : message.size();
    const ssize_t count = transport_ == Transport::Udp
                              ? sendto(listener_.get(), message.data(), expected, 0,
                                       reinterpret_cast<const sockaddr*>(&client_), sizeof client_)
                              : ::send(connection_.get(), message.data(), expected, MSG_NOSIGNAL);
    if (count > 0) {
      message = message.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (!would_block()) fail("sending to the client");
    const Duration left = deadline - WallClock{}.now();
    if (left <= Duration{0}) throw Error{"the client does not read its messages"};
    pollfd writable{descriptor(), POLLOUT, 0};
    poll(&writable, 1, static_cast<int>(left / std::chrono::milliseconds{1}) + 1);
  }
}

void Endpoint::send_last(std::span<const std::byte> message, Duration longest) {
  if (transport_ == Transport::Tcp) set(connection_.get(), IPPROTO_TCP, TCP_CORK);
  send(message, longest);
  connection_ = Descriptor{};
}

}  // namespace rths::adapters

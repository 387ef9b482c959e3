// SPDX-License-Identifier: Apache-2.0
#include "endpoint.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr std::size_t kDatagram = 9126;  // bytes that OpenSees puts into one
constexpr int kPatience = 100;           // of a client for the server's end [ms]
constexpr char kHello = 'a', kWelcome = 'b';

[[noreturn]] void fail(const std::string& what) {
  throw Error{fmt::format("{}: {}", what, std::strerror(errno))};
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

sockaddr_in place_of(const std::string& address, std::uint16_t port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &place.sin_addr) != 1)
    throw Error{fmt::format("'{}' is no address, expected one such as 127.0.0.1", address)};
  return place;
}

bool becomes_ready(int fd, short news) {
  pollfd one{fd, news, 0};
  return poll(&one, 1, kPatience) == 1 && (one.revents & news) != 0;
}

// A port that nobody listens on may be given to the socket that asks for it.
bool is_connected_to_itself(int fd) {
  sockaddr_in own{}, other{};
  socklen_t size = sizeof own;
  getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size);
  getpeername(fd, reinterpret_cast<sockaddr*>(&other), &size);
  return own.sin_port == other.sin_port && own.sin_addr.s_addr == other.sin_addr.s_addr;
}

// The length of the datagram that brings the rest of a message.
std::size_t datagram_for(std::size_t missing) { return std::min(missing, kDatagram); }

bool is_nothing_yet() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Descriptor::~Descriptor() {
  if (is_open()) close(fd_);
}

Endpoint::Endpoint(Transport transport, const std::string& address, std::uint16_t port)
    : transport_{transport}, listener_{open_socket(transport)} {
  const sockaddr_in own = place_of(address, port);
  const std::string place = fmt::format("port {} of {}", port, address);
  if (!listener_.is_open()) fail(place);
  // A test may follow the one before at once.
  if (transport == Transport::Tcp) set(listener_.get(), SOL_SOCKET, SO_REUSEADDR);
  if (bind(listener_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) fail(place);
  if (transport == Transport::Tcp && listen(listener_.get(), 1) != 0) fail(place);
}

std::optional<Endpoint> Endpoint::connect(Transport transport, const std::string& address,
                                          std::uint16_t port) {
  Endpoint end{transport};
  end.client_ = place_of(address, port);
  const auto* const place = reinterpret_cast<const sockaddr*>(&end.client_);
  Descriptor socket{open_socket(transport)};
  if (!socket.is_open()) fail("no socket");
  if (transport == Transport::Udp) {
    char welcome = 0;
    if (sendto(socket.get(), &kHello, 1, 0, place, sizeof end.client_) != 1 ||
        !becomes_ready(socket.get(), POLLIN) || recv(socket.get(), &welcome, 1, 0) != 1 ||
        welcome != kWelcome)
      return std::nullopt;
    end.listener_ = std::move(socket);
  } else {
    if (::connect(socket.get(), place, sizeof end.client_) != 0 &&
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
  if (transport_ == Transport::Udp) {
    char hello = 0;
    socklen_t size = sizeof client_;
    const ssize_t count = recvfrom(listener_.get(), &hello, 1, MSG_TRUNC,
                                   reinterpret_cast<sockaddr*>(&client_), &size);
    if (count != 1 || hello != kHello) return;
    is_connected_ = sendto(listener_.get(), &kWelcome, 1, 0,
                           reinterpret_cast<const sockaddr*>(&client_), sizeof client_) == 1;
    return;
  }
  connection_ =
      Descriptor{accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
  if (!connection_.is_open()) return;
  set(connection_.get(), IPPROTO_TCP, TCP_NODELAY);
  is_connected_ = true;
}

std::size_t Endpoint::read_datagram(std::size_t length) {
  sockaddr_in sender{};
  socklen_t size = sizeof sender;
  const std::size_t wanted = datagram_for(length - filled_);
  // A datagram that is too long is cut, and its own length told.
  const ssize_t count = recvfrom(listener_.get(), received_.data() + filled_, wanted, MSG_TRUNC,
                                 reinterpret_cast<sockaddr*>(&sender), &size);
  if (count < 0) return 0;
  if (sender.sin_port != client_.sin_port || sender.sin_addr.s_addr != client_.sin_addr.s_addr)
    return 0;  // of somebody else
  if (static_cast<std::size_t>(count) != wanted)
    throw Error{
        fmt::format("a datagram of {} bytes, expected {}: one was lost, or is none of OpenSees'",
                    count, wanted)};
  return wanted;
}

std::size_t Endpoint::read_some(std::size_t length) {
  if (transport_ == Transport::Udp) return read_datagram(length);
  const ssize_t count = recv(connection_.get(), received_.data() + filled_, length - filled_, 0);
  if (count < 0 && is_nothing_yet()) return 0;
  if (count <= 0) throw Error{"the client is gone, without code 99"};
  // OpenSees leaves Nagle's algorithm on: it holds back what follows until what came before is
  // acknowledged. The option does not last.
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
    const std::size_t wanted =
        transport_ == Transport::Udp ? datagram_for(message.size()) : message.size();
    const ssize_t count = transport_ == Transport::Udp
                              ? sendto(listener_.get(), message.data(), wanted, 0,
                                       reinterpret_cast<const sockaddr*>(&client_), sizeof client_)
                              : ::send(connection_.get(), message.data(), wanted, MSG_NOSIGNAL);
    if (count > 0) {
      message = message.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (!is_nothing_yet()) fail("sending to the client");
    const Duration left = deadline - WallClock{}.now();
    if (left <= Duration{0}) throw Error{"the client does not take what it is sent"};
    pollfd room{descriptor(), POLLOUT, 0};
    poll(&room, 1, static_cast<int>(left / std::chrono::milliseconds{1}) + 1);
  }
}

void Endpoint::send_last(std::span<const std::byte> message, Duration longest) {
  if (transport_ == Transport::Tcp) set(connection_.get(), IPPROTO_TCP, TCP_CORK);
  send(message, longest);
  connection_ = Descriptor{};
}

}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::adapters {

/// A file descriptor that its destructor closes.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_{fd} {}
  Descriptor(Descriptor&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

 private:
  int fd_;
};

/// Time for a message to be taken: the peer waits for each of ours.
inline constexpr Duration kSendDeadline = std::chrono::seconds{1};

enum class Transport { Tcp, Udp };

/// Decides whether a peer may connect, by the addresses of both ends.
using Gate = std::function<bool(const sockaddr_in& peer, const sockaddr_in& own)>;

/// The server's or the client's end of a socket with one peer. Sends and receives whole messages of
/// an agreed length. Only `connect`, `send` and `send_last` block.
class Endpoint {
 public:
  /// Opens a port. @param address  "127.0.0.1"   @throws Error if the port is not available
  Endpoint(Transport transport, const std::string& address, std::uint16_t port);
  /// Closes connections of peers that the gate refuses, and waits for another.
  void set_gate(Gate gate) { gate_ = std::move(gate); }

  /// Connects as a client. @returns nothing if the port is not open yet
  /// @throws Error if the address is invalid
  [[nodiscard]] static std::optional<Endpoint> connect(Transport transport,
                                                       const std::string& address,
                                                       std::uint16_t port);

  /// Reads the available bytes of a message of this length.
  /// @returns the message, valid until the next call, or nothing while it is incomplete
  /// @throws Error if the client has closed its socket, or a datagram was lost
  [[nodiscard]] std::span<const std::byte> receive(std::size_t length);
  /// Sends a message and waits at most for `longest` until the system has accepted it.
  /// @throws Error after that time, or if the client has closed its socket
  void send(std::span<const std::byte> message, Duration longest);

  /// Sends a message and closes the socket in one segment, so that the peer is not the first to
  /// close. The first to close would hold its port in TIME_WAIT for a minute.
  void send_last(std::span<const std::byte> message, Duration longest);

  /// Descriptor to poll.
  [[nodiscard]] int descriptor() const {
    return connection_.is_open() ? connection_.get() : listener_.get();
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }

 private:
  explicit Endpoint(Transport transport) : transport_{transport} {}
  void accept();
  void accept_stream();
  void accept_datagrams();
  [[nodiscard]] std::size_t read_some(std::size_t length);
  [[nodiscard]] std::size_t read_datagram(std::size_t length);

  Transport transport_;
  Gate gate_;                         ///< empty: every peer may connect
  Descriptor listener_, connection_;  ///< UDP uses only the first; TCP closes it when connected
  bool is_connected_ = false;
  sockaddr_in client_{};  ///< of UDP: the peer's address
  std::vector<std::byte> received_;
  std::size_t filled_ = 0;
  bool is_delivered_ = false;  ///< the caller has got the received message
};

}  // namespace rths::adapters

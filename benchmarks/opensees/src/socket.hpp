// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rths::bench {

enum class Transport { Tcp, Udp };

/// One end of a connection on this host.
class Socket {
 public:
  /// Takes ownership of a descriptor.
  explicit Socket(int fd = -1) : fd_{fd} {}
  Socket(Socket&& other) noexcept : fd_{other.fd_} { other.fd_ = -1; }
  Socket& operator=(Socket&&) = delete;
  ~Socket();

  [[nodiscard]] int get() const { return fd_; }
  /// Sends or receives a whole message. @throws Error after 10 s or if the other end is closed
  void send(std::span<const std::byte> message) const;
  void receive(std::span<std::byte> message) const;

 private:
  int fd_;
};

/// Connects as OpenSees does: TCP without further options; UDP with an initial one-byte message.
/// @throws Error if there is no answer within that time
[[nodiscard]] Socket connect_to(Transport transport, std::uint16_t port,
                                std::chrono::seconds timeout);
/// A port of this host that is free now.
[[nodiscard]] std::uint16_t free_port();
/// Binds a socket to a port of this host; TCP also listens. @throws Error if the port is in use
[[nodiscard]] Socket serve(Transport transport, std::uint16_t port);

}  // namespace rths::bench

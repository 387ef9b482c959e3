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
  /// Takes over a descriptor.
  explicit Socket(int fd = -1) : fd_{fd} {}
  Socket(Socket&& other) noexcept : fd_{other.fd_} { other.fd_ = -1; }
  Socket& operator=(Socket&&) = delete;
  ~Socket();

  [[nodiscard]] int get() const { return fd_; }
  /// Whole messages. @throws Error after ten seconds, or if the other end is gone
  void send(std::span<const std::byte> message) const;
  void receive(std::span<std::byte> message) const;

 private:
  int fd_;
};

/// Connects as OpenSees does: TCP without further options; UDP with its first letter.
/// @throws Error if nobody answers within that time
[[nodiscard]] Socket connect_to(Transport transport, std::uint16_t port,
                                std::chrono::seconds patience);
/// A port of this host that nobody listens on now.
[[nodiscard]] std::uint16_t free_port();
/// A socket on a port of this host: TCP listens. @throws Error if it cannot be had
[[nodiscard]] Socket serve(Transport transport, std::uint16_t port);

}  // namespace rths::bench

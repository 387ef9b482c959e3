// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::adapters {

/// A file descriptor that is closed with its owner.
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

enum class Transport { Tcp, Udp };

/// The server's end of one client's socket, or the client's: whole messages in, whole messages out,
/// of whatever length both sides agree on. Never blocks but where it says so.
class Endpoint {
 public:
  /// Listens. @param address  "127.0.0.1"   @throws Error if the port cannot be had
  Endpoint(Transport transport, const std::string& address, std::uint16_t port);

  /// The client's end instead. @returns nothing if the port is not open yet
  /// @throws Error if the address is none
  [[nodiscard]] static std::optional<Endpoint> connect(Transport transport,
                                                       const std::string& address,
                                                       std::uint16_t port);

  /// Takes in what has arrived, as far as a message of this length needs it.
  /// @returns the message, valid until the next call, or nothing if it is not whole yet
  /// @throws Error if the client has closed its socket, or a datagram was lost
  [[nodiscard]] std::span<const std::byte> receive(std::size_t length);
  /// Sends; waits until the system has taken all of it, at most so long.
  /// @throws Error if it has not, or the client is gone
  void send(std::span<const std::byte> message, Duration longest);

  /// Sends and hangs up in one: the other end finds both at once, and is not the first to close.
  /// Who is keeps the connection in mind for a minute, and its port with it.
  void send_last(std::span<const std::byte> message, Duration longest);

  /// To wait for news of.
  [[nodiscard]] int descriptor() const {
    return connection_.is_open() ? connection_.get() : listener_.get();
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }

 private:
  explicit Endpoint(Transport transport) : transport_{transport} {}
  void accept();
  [[nodiscard]] std::size_t read_some(std::size_t length);
  [[nodiscard]] std::size_t read_datagram(std::size_t length);

  Transport transport_;
  Descriptor listener_, connection_;  ///< UDP has the first only
  bool is_connected_ = false;
  sockaddr_in client_{};  ///< of UDP: the other end
  std::vector<std::byte> received_;
  std::size_t filled_ = 0;
  bool is_delivered_ = false;  ///< what was received went to the caller
};

}  // namespace rths::adapters

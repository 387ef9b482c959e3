// SPDX-License-Identifier: Apache-2.0
#include "endpoint.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/process.hpp"

namespace rths::adapters {
namespace {

constexpr auto kPatience = std::chrono::seconds{5};

// A client, written with system calls only.
class Peer {
 public:
  Peer(Transport transport, std::uint16_t port)
      : fd_{socket(AF_INET, transport == Transport::Tcp ? SOCK_STREAM : SOCK_DGRAM, 0)} {
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd_, reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
  }
  ~Peer() { disconnect(); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void send_bytes(std::size_t count, int value = 1) const {
    const std::string bytes(count, static_cast<char>(value));
    EXPECT_EQ(send(fd_, bytes.data(), count, 0), static_cast<ssize_t>(count));
  }
  // Returns the length of the next message.
  [[nodiscard]] std::size_t receive(std::size_t most) const {
    std::string bytes(most, 0);
    const ssize_t count = recv(fd_, bytes.data(), most, 0);
    return count < 0 ? 0 : static_cast<std::size_t>(count);
  }
  void disconnect() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

std::size_t received(Endpoint& endpoint, std::size_t length) {
  for (int i = 0; i < 100; ++i) {
    if (const auto message = endpoint.receive(length); !message.empty()) return message.size();
    pollfd readable{endpoint.descriptor(), POLLIN, 0};
    poll(&readable, 1, 50);
  }
  return 0;
}

TEST(Endpoint, JoinsTheSegmentsOfAStream) {
  const std::uint16_t port = test::free_port();
  Endpoint endpoint{Transport::Tcp, "127.0.0.1", port};
  EXPECT_TRUE(endpoint.receive(44).empty());
  const Peer peer{Transport::Tcp, port};
  peer.send_bytes(30);
  usleep(10'000);
  EXPECT_TRUE(endpoint.receive(44).empty());
  EXPECT_TRUE(endpoint.is_connected());
  peer.send_bytes(14 + 100);
  EXPECT_EQ(received(endpoint, 44), 44U);
  EXPECT_EQ(received(endpoint, 100), 100U);
  const std::vector<std::byte> reply(300);
  endpoint.send(reply, kPatience);
  EXPECT_EQ(peer.receive(1000), 300U);
}

TEST(Endpoint, SplitsAndJoinsDatagramsAsOpenSeesDoes) {
  const std::uint16_t port = test::free_port();
  Endpoint endpoint{Transport::Udp, "127.0.0.1", port};
  const Peer peer{Transport::Udp, port};
  peer.send_bytes(1, 'a');
  EXPECT_TRUE(endpoint.receive(16'000).empty());
  EXPECT_EQ(peer.receive(10), 1U);  // 'b'
  peer.send_bytes(9126);
  peer.send_bytes(16'000 - 9126);
  EXPECT_EQ(received(endpoint, 16'000), 16'000U);
  endpoint.send(std::vector<std::byte>(16'000), kPatience);
  EXPECT_EQ(peer.receive(20'000), 9126U);
  EXPECT_EQ(peer.receive(20'000), 6874U);
}

TEST(Endpoint, DetectsALostDatagram) {
  const std::uint16_t port = test::free_port();
  Endpoint endpoint{Transport::Udp, "127.0.0.1", port};
  const Peer peer{Transport::Udp, port}, other{Transport::Udp, port};
  peer.send_bytes(1, 'a');
  EXPECT_TRUE(endpoint.receive(16'000).empty());
  other.send_bytes(9126);  // from another sender: ignored
  peer.send_bytes(6874);   // the first datagram is lost
  EXPECT_THROW(static_cast<void>(received(endpoint, 16'000)), Error);
}

TEST(Endpoint, DetectsAClosedConnection) {
  const std::uint16_t port = test::free_port();
  Endpoint endpoint{Transport::Tcp, "127.0.0.1", port};
  Peer peer{Transport::Tcp, port};
  peer.send_bytes(44);
  EXPECT_EQ(received(endpoint, 44), 44U);
  peer.disconnect();
  EXPECT_THROW(static_cast<void>(received(endpoint, 44)), Error);
}

TEST(Endpoint, SaysWhyItCannotListen) {
  const std::uint16_t port = test::free_port();
  const Endpoint endpoint{Transport::Tcp, "127.0.0.1", port};
  EXPECT_THROW((Endpoint{Transport::Tcp, "127.0.0.1", port}), Error);
  EXPECT_THROW((Endpoint{Transport::Tcp, "nowhere", port}), Error);
}

}  // namespace
}  // namespace rths::adapters

// SPDX-License-Identifier: Apache-2.0
//
// ZeroMQ: a PAIR of sockets over ipc; each side sleeps until a message arrives.
#include <unistd.h>

#include <string>
#include <vector>

#include <zmq.h>

#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr int kTimeout = 5'000;  // [ms]

class SocketEnd {
 public:
  SocketEnd(const std::string& endpoint, bench::Side side, std::uint32_t bytes)
      : context_{zmq_ctx_new()}, socket_{zmq_socket(context_, ZMQ_PAIR)}, message_(bytes) {
    constexpr int kDiscard = 0;
    zmq_setsockopt(socket_, ZMQ_LINGER, &kDiscard, sizeof kDiscard);
    zmq_setsockopt(socket_, ZMQ_RCVTIMEO, &kTimeout, sizeof kTimeout);
    const int problem = side == bench::Side::Near ? zmq_bind(socket_, endpoint.c_str())
                                                  : zmq_connect(socket_, endpoint.c_str());
    if (problem != 0) throw Error{zmq_strerror(zmq_errno())};
  }
  ~SocketEnd() {
    zmq_close(socket_);
    zmq_ctx_term(context_);
  }
  SocketEnd(const SocketEnd&) = delete;
  SocketEnd& operator=(const SocketEnd&) = delete;

  void send(std::uint32_t number) {
    mark(message_.data(), message_.size(), number);
    if (zmq_send(socket_, message_.data(), message_.size(), 0) < 0)
      throw Error{zmq_strerror(zmq_errno())};
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    if (zmq_recv(socket_, message_.data(), message_.size(), 0) < 0)
      throw Error{zmq_strerror(zmq_errno())};
    return number_of(message_.data(), message_.size()) == number;
  }

 private:
  void* context_;
  void* socket_;
  std::vector<std::byte> message_;
};

bench::Times measure(const Request& request) {
  // An abstract name: leaves no file behind.
  const std::string endpoint = "ipc://@rths_peer_zeromq_" + std::to_string(getpid());
  return bench::round_trips(request.setup, [&](bench::Side side) {
    return SocketEnd{endpoint, side, request.bytes};
  });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  return rths::peers::run_peer(argc, argv, {{"round_trips", rths::peers::measure}});
}

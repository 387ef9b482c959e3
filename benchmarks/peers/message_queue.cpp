// SPDX-License-Identifier: Apache-2.0
//
// Boost.Interprocess message_queue: a mutex and two conditions in shared memory; polled.
#include <string>
#include <vector>

#include <unistd.h>

#include <boost/interprocess/ipc/message_queue.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

namespace ipc = boost::interprocess;

constexpr std::size_t kDepth = 8;

/// The two queues; the destructor removes their names.
class Queues {
 public:
  explicit Queues(std::size_t bytes)
      : stem_{"rths_peer_message_queue_" + std::to_string(getpid())},
        near_{ipc::create_only, (stem_ + "_near").c_str(), kDepth, bytes},
        far_{ipc::create_only, (stem_ + "_far").c_str(), kDepth, bytes} {}
  ~Queues() {
    ipc::message_queue::remove((stem_ + "_near").c_str());
    ipc::message_queue::remove((stem_ + "_far").c_str());
  }
  Queues(const Queues&) = delete;
  Queues& operator=(const Queues&) = delete;

  /// The queue that a side writes to.
  [[nodiscard]] ipc::message_queue& of(bench::Side writer) {
    return writer == bench::Side::Near ? near_ : far_;
  }

 private:
  std::string stem_;
  ipc::message_queue near_, far_;
};

class QueueEnd {
 public:
  QueueEnd(Queues& queues, bench::Side side, std::size_t bytes)
      : out_{queues.of(side)}, in_{queues.of(bench::other(side))}, message_(bytes) {}
  void send(std::uint32_t number) {
    mark(message_.data(), message_.size(), number);
    out_.send(message_.data(), message_.size(), 0);
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    std::size_t size = 0;
    unsigned priority = 0;
    return in_.try_receive(message_.data(), message_.size(), size, priority) &&
           number_of(message_.data(), size) == number;
  }

 private:
  ipc::message_queue& out_;
  ipc::message_queue& in_;
  std::vector<std::byte> message_;
};

bench::Times measure(const Request& request) {
  Queues queues{request.bytes};
  return bench::round_trips(request.setup, [&](bench::Side side) {
    return QueueEnd{queues, side, request.bytes};
  });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  return rths::peers::run_peer(argc, argv, {{"round_trips", rths::peers::measure}});
}

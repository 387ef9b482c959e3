// SPDX-License-Identifier: Apache-2.0
//
// boost::lockfree::spsc_queue, one in each direction, laid into shared memory.
#include <array>

#include <boost/lockfree/spsc_queue.hpp>

#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr std::size_t kDepth = 64;

template <std::size_t bytes>
struct Queues {
  using Message = std::array<std::byte, bytes>;
  using Queue = boost::lockfree::spsc_queue<Message, boost::lockfree::capacity<kDepth>>;
  alignas(128) Queue near;
  alignas(128) Queue far;
};

template <std::size_t bytes>
class QueueEnd {
 public:
  QueueEnd(Queues<bytes>& queues, bench::Side side)
      : out_{side == bench::Side::Near ? queues.near : queues.far},
        in_{side == bench::Side::Near ? queues.far : queues.near} {}
  void send(std::uint32_t number) {
    mark(sent_.data(), bytes, number);
    out_.push(sent_);
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    return in_.pop(received_) && number_of(received_.data(), bytes) == number;
  }

 private:
  typename Queues<bytes>::Queue& out_;
  typename Queues<bytes>::Queue& in_;
  typename Queues<bytes>::Message sent_{}, received_{};
};

template <std::size_t bytes>
bench::Times measure_size(const bench::Setup& setup) {
  // In shared pages from birth to death: both processes see it at one address.
  const bench::SharedPages pages{sizeof(Queues<bytes>)};
  auto* const queues = new (pages.address()) Queues<bytes>;
  const bench::Times times = bench::round_trips(setup, [&](bench::Side side) {
    return QueueEnd<bytes>{*queues, side};
  });
  queues->~Queues<bytes>();
  return times;
}

bench::Times measure(const Request& request) {
  switch (request.bytes) {
    case 8:
      return measure_size<8>(request.setup);
    case 64:
      return measure_size<64>(request.setup);
    default:
      throw Error{"expected 8 or 64 bytes"};
  }
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) { return rths::peers::run_peer(argc, argv, rths::peers::measure); }

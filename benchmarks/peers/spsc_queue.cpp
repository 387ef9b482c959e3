// SPDX-License-Identifier: Apache-2.0
//
// boost::lockfree::spsc_queue, one in each direction, in shared memory.
#include <array>

#include <rths/bench/stream.hpp>

#include <boost/lockfree/spsc_queue.hpp>

#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr std::size_t kDepth = 4096;

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
  [[nodiscard]] bool offer(std::uint32_t number) {
    mark(sent_.data(), bytes, number);
    return out_.push(sent_);
  }
  [[nodiscard]] bool take(std::uint32_t& number) {
    if (!in_.pop(received_)) return false;
    number = number_of(received_.data(), bytes);
    return true;
  }

 private:
  typename Queues<bytes>::Queue& out_;
  typename Queues<bytes>::Queue& in_;
  typename Queues<bytes>::Message sent_{}, received_{};
};

// Constructed and destroyed in shared pages, which both processes have at one address.
template <std::size_t bytes, class Measure>
bench::Times with_queues(Measure measure) {
  const bench::SharedPages pages{sizeof(Queues<bytes>)};
  auto* const queues = new (pages.address()) Queues<bytes>;
  const bench::Times times = measure([&](bench::Side side) {
    return QueueEnd<bytes>{*queues, side};
  });
  queues->~Queues<bytes>();
  return times;
}

bench::Times round_trips(const Request& request) {
  const auto measure = [&](auto make_end) { return bench::round_trips(request.setup, make_end); };
  switch (request.bytes) {
    case 8:
      return with_queues<8>(measure);
    case 64:
      return with_queues<64>(measure);
    default:
      throw Error{"expected 8 or 64 bytes"};
  }
}

bench::Times stream(const Request& request) {
  if (request.bytes != 8) throw Error{"expected 8 bytes"};
  return with_queues<8>(
      [&](auto make_end) { return bench::stream_times(request.setup, make_end); });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  using namespace rths::peers;
  return run_peer(argc, argv, {{"round_trips", round_trips}, {"stream", stream}});
}

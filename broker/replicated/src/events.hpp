// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include <rths/replicated/ring.hpp>

namespace rths::replicated {

/// Something that happens to a message or a transmitter at a node.
struct Event {
  enum class Kind : std::uint8_t {
    Head,      ///< a node has recognised a message at its input
    Received,  ///< the last bit of a message is in
    Transmit,  ///< a node may start an own message
    Extend,    ///< an open message may get another longword
    Timeout    ///< an own message has not returned in time
  };
  Time time{0};
  std::uint64_t sequence = 0;
  std::uint32_t subject = 0;  ///< message, or number of the attempt
  std::uint16_t node = 0;
  Kind kind = Kind::Head;
  bool own = false, damaged = false;
};

/// Events in the order of (time, node, sequence).
class EventQueue {
 public:
  void post(Event event) {
    event.sequence = next_++;
    heap_.push_back(event);
    std::push_heap(heap_.begin(), heap_.end(), is_later);
  }
  [[nodiscard]] bool is_empty() const { return heap_.empty(); }
  [[nodiscard]] const Event& first() const { return heap_.front(); }
  Event take_first() {
    std::pop_heap(heap_.begin(), heap_.end(), is_later);
    const Event event = heap_.back();
    heap_.pop_back();
    return event;
  }

 private:
  static bool is_later(const Event& a, const Event& b) {
    return std::tie(a.time, a.node, a.sequence) > std::tie(b.time, b.node, b.sequence);
  }

  std::vector<Event> heap_;
  std::uint64_t next_ = 0;
};

}  // namespace rths::replicated

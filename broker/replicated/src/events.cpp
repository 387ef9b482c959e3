// SPDX-License-Identifier: Apache-2.0
#include "events.hpp"

#include <algorithm>
#include <tuple>

namespace rths::replicated {
namespace {

bool is_later(const Event& a, const Event& b) {
  return std::tie(a.time, a.node, a.sequence) > std::tie(b.time, b.node, b.sequence);
}

}  // namespace

void EventQueue::post(Event event) {
  event.sequence = next_++;
  heap_.push_back(event);
  std::push_heap(heap_.begin(), heap_.end(), is_later);
}

Event EventQueue::take_first() {
  std::pop_heap(heap_.begin(), heap_.end(), is_later);
  const Event event = heap_.back();
  heap_.pop_back();
  return event;
}

}  // namespace rths::replicated

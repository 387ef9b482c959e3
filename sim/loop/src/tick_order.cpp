// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/tick_order.hpp>

#include <algorithm>

namespace rths::loop {
namespace {

// Whether a tick of a node has the outputs of a tick of another.
bool has_seen(const TickTimes& reader, std::size_t tick, const TickTimes& writer,
              std::size_t written) {
  if (!reader.is_missed(tick)) return writer.end[written] <= reader.begin[tick];
  const double dated = writer.is_missed(written) ? writer.due[written] : writer.end[written];
  return dated < reader.due[tick];
}

}  // namespace

TickOrder order_of(const TickTimes& machine, const TickTimes& controller) {
  TickOrder order;
  order.missed = controller.missed;
  bool is_on_time = std::ranges::find(order.missed, true) == order.missed.end();
  const std::size_t moves = machine.begin.size(), answers = controller.begin.size();
  for (std::size_t n = 0, m = 0; n < answers; ++n) {
    while (m < moves && has_seen(controller, n, machine, m)) ++m;
    order.machine_before.push_back(m);
    is_on_time = is_on_time && (m == n + 1 || m == moves);
  }
  for (std::size_t m = 0, n = 0; m < moves; ++m) {
    while (n < answers && has_seen(machine, m, controller, n)) ++n;
    order.controller_before.push_back(n);
    is_on_time = is_on_time && (n == m || n == answers);
  }
  return is_on_time ? TickOrder{} : order;
}

std::size_t Host::arrival(std::size_t next, std::size_t tick) const {
  const int ticks = computing.empty() ? 1 : computing[std::min(next, computing.size()) - 1];
  const std::size_t expected = tick + static_cast<std::size_t>(std::max(1, ticks));
  if (next >= arrivals.size()) return expected;
  return std::max(std::clamp(expected, arrivals[next].first, arrivals[next].last), tick + 1);
}

}  // namespace rths::loop

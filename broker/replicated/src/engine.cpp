// SPDX-License-Identifier: Apache-2.0
//
// The way of a message around the ring: recognised at a node's input, sent on when the output is
// free, removed by its own node or at the end of its life.
#include "engine.hpp"

#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::replicated {
namespace {

constexpr Time kUnknown = Time::max();
constexpr std::size_t kMostNodes = 256;

std::uint64_t next_random(std::uint64_t& state) {  // splitmix64
  std::uint64_t z = state += 0x9E37'79B9'7F4A'7C15;
  z = (z ^ z >> 30) * 0xBF58'476D'1CE4'E5B9;
  z = (z ^ z >> 27) * 0x94D0'49BB'1331'11EB;
  return z ^ z >> 31;
}

void check(const RingSetup& setup) {
  if (setup.nodes.empty() || setup.nodes.size() > kMostNodes)
    throw Error{fmt::format("{} nodes, expected 1 to {}", setup.nodes.size(), kMostNodes)};
  for (const auto& node : setup.nodes) {
    if (node.id > 255) throw Error{fmt::format("node id {}, expected 0 to 255", node.id)};
    if (!(node.fibre_m >= 0 && node.fibre_m <= 1e6))
      throw Error{fmt::format("fibre of {} m, expected 0 to 1,000,000 m", node.fibre_m)};
    if (node.memory_bytes == 0 || node.memory_bytes % 4 != 0 || node.memory_bytes > 512U << 20U)
      throw Error{fmt::format("memory of {} bytes", node.memory_bytes)};
  }
}

}  // namespace

Engine::Engine(const RingSetup& setup)
    : type_{setup.cards},
      rates_{setup.cards == CardType::Plus ? kPlusRates : kGtRates},
      strict_ids_{setup.strict_ids},
      bit_error_rate_{setup.bit_error_rate},
      random_{setup.seed} {
  check(setup);
  for (const auto& node : setup.nodes) nodes_.emplace_back(node, type_);
  for (std::uint32_t at = 0; at < nodes_.size(); ++at) power_up(at);
}

void Engine::run_until(Time time) {
  while (!events_.is_empty() && events_.first().time <= time) process(events_.take_first());
  now_ = std::max(now_, time);
}

bool Engine::run_until_idle(Time limit) {
  while (messages_.in_use() != 0 || scheduled_ != 0) {
    if (events_.is_empty() || events_.first().time > limit) {
      now_ = std::max(now_, limit);
      return false;
    }
    process(events_.take_first());
  }
  return true;
}

void Engine::process(const Event& event) {
  now_ = event.time;
  switch (event.kind) {
    case Event::Kind::Head:
      return on_head(event.subject, event.node);
    case Event::Kind::Received:
      return on_received(event);
    case Event::Kind::Transmit:
      return on_transmit(event.node);
    case Event::Kind::Extend:
      return on_extend(event.node);
    case Event::Kind::Timeout:
      return on_timeout(event.node, event.subject);
  }
}

void Engine::post(Event::Kind kind, std::uint32_t node, Time time, std::uint32_t subject) {
  Event event;
  event.time = std::max(time, now_);
  event.subject = subject;
  event.node = static_cast<std::uint16_t>(node);
  event.kind = kind;
  events_.post(event);
}

void Engine::log(Hop::Kind kind, const Message& message, std::uint32_t at, Time begin, Time end) {
  const std::uint64_t what = static_cast<std::uint64_t>(begin.count()) * 0x9E37'79B9'7F4A'7C15 +
                             (message.number << 20U | at << 8U | static_cast<std::uint64_t>(kind));
  log_hash = (log_hash ^ what) * 0x100'0000'01B3;
  log_hash ^= log_hash >> 29U;
  if (!observer) return;
  observer({kind, at, message.number, message.origin, ByteOffset{message.address},
            static_cast<std::uint32_t>(message.longwords.size()), message.age, begin, end});
}

std::uint32_t Engine::behind(std::uint32_t node) const {
  return node + 1 == nodes_.size() ? 0 : node + 1;
}

// The head of a message is recognised `gap` before it can leave the node.
void Engine::on_head(std::uint32_t index, std::uint32_t at) {
  CardNode& node = nodes_[at];
  Message& message = messages_[index];
  const bool connected = message.looped || node.path == Path::Inserted;
  node.input.start = message.arrival;
  node.input.own = is_own_id(node, message);
  node.input.received = connected || node.path == Path::Monitor;
  if (message.open) {
    node.input.open = index;
  } else {
    damage(message);
    if (node.input.received) expect_reception(index, at);
  }
  if (!connected) return pass_optically(index, at);
  if (node.input.own) {
    if (message.origin == at) node.round_trip = message.arrival - message.sent;
    log(Hop::Kind::Removed, message, at);
    return end_head(index);
  }
  if (message.age == kLastAge) {
    log(Hop::Kind::Expired, message, at);
    return end_head(index);
  }
  ++message.age;
  message.ready = std::max(message.arrival + rates_.node_delay + node.extra_delay, now_);
  forward(index, at);
}

void Engine::pass_optically(std::uint32_t index, std::uint32_t at) {
  const CardNode& node = nodes_[at];
  if (node.bypass_switch && node.path != Path::Breaking)
    return send_to_next(index, at, messages_[index].arrival);
  log(Hop::Kind::Broken, messages_[index], at);
  end_head(index);
}

void Engine::forward(std::uint32_t index, std::uint32_t at) {
  CardNode& node = nodes_[at];
  Message& message = messages_[index];
  const bool waits = node.waiting != 0 || node.output.open != kNone;
  if (!waits && !own_goes_first(node, message.ready))
    return put_on_line(index, at, std::max(message.ready, node.output.free));
  (node.waiting == 0 ? node.waiting_first : messages_[node.waiting_last].next) = index;
  node.waiting_last = index;
  ++node.waiting;
}

// A message of the ring that waits for the line goes first. One that comes within the gap before
// an own message goes first, too, but only one: so no node can keep another from sending.
bool Engine::own_goes_first(CardNode& node, Time ready) const {
  if (!node.transmit_scheduled || ready < std::max(node.output.free, node.transmit_at))
    return false;
  const bool goes_first = node.yielded;
  node.yielded = true;
  return goes_first;
}

void Engine::drain(std::uint32_t at) {
  CardNode& node = nodes_[at];
  while (node.waiting != 0 && node.output.open == kNone) {
    const std::uint32_t index = node.waiting_first;
    if (own_goes_first(node, messages_[index].ready)) return;
    node.waiting_first = messages_[index].next;
    --node.waiting;
    put_on_line(index, at, std::max(messages_[index].ready, node.output.free));
  }
}

void Engine::put_on_line(std::uint32_t index, std::uint32_t at, Time start) {
  CardNode& node = nodes_[at];
  Message& message = messages_[index];
  node.output.start = start;
  ++hops;
  Hop::Kind kind = Hop::Kind::Passed;
  if (!message.on_ring) {
    message.on_ring = true;
    ++(message.repeated ? node.counts.repeated : node.counts.sent);
    kind = message.repeated ? Hop::Kind::Repeated : Hop::Kind::Inserted;
  } else {
    ++node.counts.passed;
    node.counts.longest_delay = std::max(node.counts.longest_delay, start - message.arrival);
  }
  if (message.open) {
    node.output.open = index;
    node.output.free = kUnknown;
  } else {
    const Time end = start + rates_.message(static_cast<std::uint32_t>(message.longwords.size()));
    node.output.free = end + rates_.gap;
    log(kind, message, at, start, end);
  }
  send_to_next(index, at, start);
}

void Engine::send_to_next(std::uint32_t index, std::uint32_t from, Time start) {
  Message& message = messages_[index];
  const CardNode& node = nodes_[from];
  if (!message.looped && !node.connected) {
    log(Hop::Kind::Broken, message, from);
    return end_head(index);
  }
  const std::uint32_t to = message.looped ? from : behind(from);
  message.arrival = start + (message.looped ? Time{0} : node.fibre);
  const Time delay = rates_.node_delay + nodes_[to].extra_delay;
  post(Event::Kind::Head, to, message.arrival + delay - rates_.gap, index);
}

// The length of an open message is known now: so are the ends of its passages and receptions.
void Engine::close(std::uint32_t index) {
  Message& message = messages_[index];
  message.open = false;
  const Time duration = rates_.message(static_cast<std::uint32_t>(message.longwords.size()));
  const auto end_output = [&](std::uint32_t at) {
    CardLine& output = nodes_[at].output;
    if (output.open != index) return;
    output.open = kNone;
    output.free = output.start + duration + rates_.gap;
    log(at != message.origin ? Hop::Kind::Passed : Hop::Kind::Inserted, message, at, output.start,
        output.start + duration);
    drain(at);
    schedule_transmit(at, now_);
  };
  ++message.receivers;  // keeps it until the end of this function
  end_output(message.origin);
  std::uint32_t at = message.looped ? message.origin : behind(message.origin);
  while (nodes_[at].input.open == index) {
    nodes_[at].input.open = kNone;
    damage(message);
    if (nodes_[at].input.received) expect_reception(index, at);
    end_output(at);
    if (!message.looped) at = behind(at);
  }
  --message.receivers;
  release_if_done(index);
}

void Engine::expect_reception(std::uint32_t index, std::uint32_t at) {
  Message& message = messages_[index];
  const CardLine& input = nodes_[at].input;
  Event event;
  event.time = input.start + rates_.message(static_cast<std::uint32_t>(message.longwords.size()));
  event.subject = index;
  event.node = static_cast<std::uint16_t>(at);
  event.kind = Event::Kind::Received;
  event.own = input.own;
  event.damaged = message.damaged;
  events_.post(event);
  ++message.receivers;
}

void Engine::damage(Message& message) {
  if (bit_error_rate_ == 0) return;
  const Time duration = rates_.message(static_cast<std::uint32_t>(message.longwords.size()));
  const auto bits = static_cast<double>(duration / (type_ == CardType::Plus ? kBit : kByte / 10));
  const double uniform = static_cast<double>(next_random(random_) >> 11U) * 0x1p-53;
  if (uniform < -std::expm1(bits * std::log1p(-bit_error_rate_))) message.damaged = true;
}

void Engine::end_head(std::uint32_t index) {
  messages_[index].on_ring = false;
  release_if_done(index);
}

void Engine::release_if_done(std::uint32_t index) {
  const Message& message = messages_[index];
  if (!message.on_ring && !message.open && message.receivers == 0) messages_.give_back(index);
}

}  // namespace rths::replicated

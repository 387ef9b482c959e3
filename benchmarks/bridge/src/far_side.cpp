// SPDX-License-Identifier: Apache-2.0
#include "far_side.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>

#include "maps.hpp"

namespace rths::bench {
namespace {

constexpr Duration kLongestWait = std::chrono::seconds{60};

dds::CycloneOptions loopback(std::uint32_t domain, const std::string& ring) {
  dds::CycloneOptions options;
  options.domain = domain;
  options.interface = "127.0.0.1";
  options.peers = {"127.0.0.1"};
  options.ring = ring;
  return options;
}

// Tags are written once each, in rising order. @param next  the next expected tag
Message follow(broker::Follower& follower, std::uint64_t& next, std::uint64_t last) {
  const WallClock clock;
  const TimePoint deadline = clock.now() + kLongestWait;
  Message answer;
  while (next <= last) {
    broker::Write write{};
    if (follower.next(write) != broker::Followed::Write) {
      if (clock.now() > deadline) break;
      std::this_thread::sleep_for(std::chrono::microseconds{50});
      continue;
    }
    if (write.offset != kNearWord || write.value == 0) continue;  // of the first snapshot
    if (write.value < next) ++answer.reordered;
    if (write.value > next) answer.lost += write.value - next;
    next = std::max<std::uint64_t>(next, write.value + 1ULL);
  }
  answer.lost += last + 1 - next;
  next = last + 1;
  return answer;
}

void echo(broker::Node& far, broker::Waiter& waiter, std::uint64_t writes) {
  const WallClock clock;
  for (std::uint64_t i = 0; i < writes; ++i) {
    broker::Write write{};
    if (waiter.wait(clock.now() + kLongestWait, write) != Status::Ok) return;
    static_cast<void>(far.write(kFarWord, write.value));
  }
}

// The time from the announcement of the node to the last word of its image.
Message receive_image(std::uint32_t domain) {
  OpenRing open{"image", "far", image_map(), domain};
  const broker::Node reader = open.ring().observe();
  wait_for("the announcement of the image",
           [&] { return reader.presence_of(NodeId{1}).state == broker::Presence::State::Alive; });
  const WallClock clock;
  const TimePoint begun = clock.now();
  wait_for("the image", [&] { return open.gateway().counts().snapshots > 0; });
  Message answer;
  answer.seconds = to_seconds(clock.now() - begun);
  for (std::uint32_t i = 0; i < kImageLongwords; ++i)
    answer.lost += reader.read(LongwordOffset{i}) == i + 1 ? 0 : 1;
  return answer;
}

}  // namespace

OpenRing::OpenRing(const std::string& joint_name, const std::string& side, const memmap::Map& map,
                   std::uint32_t domain)
    : name_{fmt::format("bridge_{}_{}_{}", joint_name, side, getpid())},
      ring_{broker::Ring::create(name_, map, kJournalBits)} {
  dds::GatewayOptions options;
  options.host = side;
  gateway_ = std::make_unique<dds::Gateway>(
      name_, dds::make_cyclone_carrier(loopback(domain, joint_name)), options);
}

OpenRing::~OpenRing() {
  gateway_.reset();
  broker::remove_ring(name_);
}

double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void wait_for(const char* what, const std::function<bool()>& condition) {
  const WallClock clock;
  const TimePoint deadline = clock.now() + kLongestWait;
  while (!condition()) {
    if (clock.now() > deadline) throw Error{fmt::format("waited in vain for {}", what)};
    std::this_thread::sleep_for(std::chrono::microseconds{100});
  }
}

void run_far_side(std::uint32_t domain) {
  Samples samples{domain};
  OpenRing open{"words", "far", small_map(), domain + 1};
  broker::Node far = open.ring().join("far", 0);
  broker::Follower follower = open.ring().follow("near");
  broker::Waiter waiter = open.ring().wait_for({{kNearWord, 1}}, Duration{0});
  std::uint64_t count = 0, tag = 1;
  for (;;) {
    Message message = samples.receive();
    switch (message.kind) {
      case Message::kSample:
        ++count;
        continue;
      case Message::kCount:
        message.lost = message.number - count;
        count = 0;
        break;
      case Message::kFollow:
        message = follow(follower, tag, message.number);
        break;
      case Message::kEcho:
        // Writes of earlier rows are not to be answered.
        for (broker::Write write{}; waiter.wait(TimePoint{0}, write) != Status::Late;) continue;
        samples.send(message);
        echo(far, waiter, message.number);
        continue;
      case Message::kImage:
        message = receive_image(domain + 1);
        break;
      case Message::kRest: {
        const double before = processor_time();
        std::this_thread::sleep_for(std::chrono::milliseconds{message.number});
        message.seconds = processor_time() - before;
        break;
      }
      case Message::kEnd:
        return;
      default:
        break;
    }
    samples.send(message);
  }
}

}  // namespace rths::bench

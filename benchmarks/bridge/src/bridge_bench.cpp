// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/bridge_bench.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include <rths/bench/load.hpp>
#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

#include "far_side.hpp"
#include "maps.hpp"

namespace rths::bench {
namespace {

constexpr Duration kLongest = std::chrono::seconds{20};
constexpr std::uint64_t kMostAhead = 1U << 18;     // of a journal of 2^20 entries
constexpr std::size_t kImageSample = 56UL * 1024;  // [B]
constexpr int kImageSamples = 300;
constexpr int kWarmUp = 100;                // round trips
constexpr std::uint64_t kLoadSteps = 3000;  // 1 kHz
constexpr std::uint64_t kSeed = 1;          // of the intervals

/// The second process, killed at the end.
class FarProcess {
 public:
  explicit FarProcess(std::uint32_t domain) {
    std::fflush(nullptr);
    pid_ = fork();
    if (pid_ < 0) throw Error{"the second process cannot be started"};
    if (pid_ > 0) return;
    try {
      run_far_side(domain);
    } catch (const std::exception& error) {
      write_message(fmt::format("rths: the second process: {}\n", error.what()));
    }
    std::_Exit(0);
  }
  ~FarProcess() {
    for (int look = 0; look < 100 && waitpid(pid_, nullptr, WNOHANG) == 0; ++look)
      std::this_thread::sleep_for(std::chrono::milliseconds{20});
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  FarProcess(const FarProcess&) = delete;
  FarProcess& operator=(const FarProcess&) = delete;

 private:
  pid_t pid_ = -1;
};

class NearSide {
 public:
  NearSide(Samples& samples, std::uint32_t domain)
      : samples_{samples},
        open_{"words", "near", small_map(), domain},
        near_{open_.ring().join("near", 0)},
        waiter_{open_.ring().wait_for({{kFarWord, 1}}, Duration{0})} {
    wait_for("the ring of the second process", [&] {
      return near_.presence_of(NodeId{2}).state == broker::Presence::State::Alive &&
             open_.gateway().counts().snapshots > 0;
    });
  }

  /// Bare samples of one word each. @returns samples per second
  double send_samples(std::uint32_t count) {
    const TimePoint begun = clock_.now();
    for (std::uint32_t i = 0; i < count; ++i) samples_.send({Message::kSample});
    const Message answer = ask({Message::kCount, count});
    if (answer.lost != 0) throw Error{fmt::format("{} bare samples were lost", answer.lost)};
    return count / to_seconds(clock_.now() - begun);
  }
  /// @returns bytes per second of large samples
  double send_bytes() {
    const TimePoint begun = clock_.now();
    for (int i = 0; i < kImageSamples; ++i) samples_.send_bytes(kImageSample);
    static_cast<void>(ask({Message::kCount, kImageSamples}));
    return kImageSamples * static_cast<double>(kImageSample) / to_seconds(clock_.now() - begun);
  }
  /// Writes through the ring. @returns updates per second
  double write(std::uint32_t count, BridgeReport& report) {
    const auto before = open_.gateway().counts();
    const std::uint64_t sent = before.updates_sent;
    samples_.send({Message::kFollow, tag_ + count});
    const TimePoint begun = clock_.now();
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i % 1024 == 0)
        while (i - (open_.gateway().counts().updates_sent - sent) > kMostAhead)
          std::this_thread::sleep_for(std::chrono::microseconds{100});
      write_next();
    }
    const Message answer = samples_.receive();
    const double seconds = to_seconds(clock_.now() - begun);
    const auto after = open_.gateway().counts();
    report.lost += answer.lost;
    report.reordered += answer.reordered;
    report.updates_per_frame = static_cast<double>(after.updates_sent - before.updates_sent) /
                               static_cast<double>(after.frames_sent - before.frames_sent);
    return count / seconds;
  }
  /// One-way times through the ring [ns].
  std::vector<double> ring_trips(int round_trips) {
    static_cast<void>(ask({Message::kEcho, static_cast<std::uint64_t>(round_trips + kWarmUp)}));
    std::vector<double> times;
    for (int i = 0; i < round_trips + kWarmUp; ++i) {
      const TimePoint begun = clock_.now();
      write_next();
      broker::Write write{};
      do {
        if (waiter_.wait(begun + kLongest, write) != Status::Ok)
          throw Error{"the second process does not answer through the ring"};
      } while (write.value != static_cast<std::uint32_t>(tag_));
      if (i >= kWarmUp) times.push_back(one_way(begun));
    }
    return times;
  }
  std::vector<double> bare_trips(int round_trips) {
    std::vector<double> times;
    for (int i = 0; i < round_trips + kWarmUp; ++i) {
      const TimePoint begun = clock_.now();
      static_cast<void>(ask({Message::kHere}));
      if (i >= kWarmUp) times.push_back(one_way(begun));
    }
    return times;
  }
  void measure_load(BridgeReport& report) {
    const double before = processor_time();
    samples_.send({Message::kRest, kLoadSteps});
    const TimePoint begun = clock_.now();
    for (std::uint64_t step = 0; step < kLoadSteps; ++step) {
      clock_.sleep_until(begun + step * std::chrono::milliseconds{1});
      for (std::uint32_t i = 1; i < kStepWords; ++i)
        static_cast<void>(near_.write(advance(kNearWord, i), static_cast<std::uint32_t>(step)));
    }
    const double seconds = to_seconds(clock_.now() - begun);
    report.near_share = (processor_time() - before) / seconds;
    report.far_share = samples_.receive().seconds / seconds;
  }

  Message ask(const Message& message) {
    samples_.send(message);
    return samples_.receive();
  }

 private:
  void write_next() {
    static_cast<void>(near_.write(kNearWord, static_cast<std::uint32_t>(++tag_)));
  }
  [[nodiscard]] double one_way(TimePoint begun) const {
    return 0.5 * static_cast<double>((clock_.now() - begun).count());
  }

  Samples& samples_;
  OpenRing open_;
  broker::Node near_;
  broker::Waiter waiter_;
  WallClock clock_;
  std::uint64_t tag_ = 0;
};

// The second process opens its ring of 8 MiB to the network, and gets the whole image. @returns [s]
double measure_resync(Samples& samples, std::uint32_t domain, BridgeReport& report) {
  OpenRing open{"image", "near", image_map(), domain};
  broker::Node near = open.ring().join("near", 0);
  for (std::uint32_t i = 0; i < kImageLongwords; ++i)
    static_cast<void>(near.write(LongwordOffset{i}, i + 1));
  wait_for("the journal to be sent", [&] {
    return open.gateway().counts().lapped > 0 ||
           open.gateway().counts().updates_sent >= kImageLongwords;
  });
  samples.send({Message::kImage});
  const Message answer = samples.receive();
  report.lost += answer.lost;
  return answer.seconds;
}

void measure(const BridgeOptions& options, BridgeReport& report) {
  Samples samples{options.domain};
  // The first message waits until the two processes have found each other.
  std::this_thread::sleep_for(std::chrono::seconds{1});
  NearSide near{samples, options.domain + 1};
  std::vector<double> updates, bare, ratios, bytes;
  std::vector<Times> ring, straight;
  std::vector<double> trips;
  for (int cycle = 0; cycle < options.cycles; ++cycle) {
    bare.push_back(near.send_samples(options.samples));
    updates.push_back(near.write(options.updates, report));
    ratios.push_back(updates.back() / bare.back());
    straight.push_back(times_of(near.bare_trips(options.round_trips)));
    ring.push_back(times_of(near.ring_trips(options.round_trips)));
    trips.push_back(ring.back().p50 / straight.back().p50);
    bytes.push_back(near.send_bytes());
  }
  report.updates_per_s = median(updates);
  report.samples_per_s = median(bare);
  report.updates_ratio = median(ratios);
  report.latency = median(ring);
  report.bare_latency = median(straight);
  report.latency_ratio_p50 = median(trips);
  report.latency_ratio_interval = median_interval(trips, kSeed);
  near.measure_load(report);
  std::vector<double> resyncs;
  for (int cycle = 0; cycle < options.cycles; ++cycle)
    resyncs.push_back(measure_resync(samples, options.domain + 1, report));
  report.resync_s = median(resyncs);
  report.bare_bytes_per_s = median(bytes);
  report.resync_ratio = report.resync_s / (4.0 * kImageLongwords / report.bare_bytes_per_s);
  samples.send({Message::kEnd});
}

GateResult result_of(const BridgeReport& report) {
  if (report.lost > 0 || report.reordered > 0) return GateResult::Fail;
  if (!report.troubles.empty()) return GateResult::Inconclusive;
  const bool holds =
      report.updates_ratio >= kUpdatesGate && report.latency_ratio_p50 <= kLatencyGate;
  return holds ? GateResult::Pass : GateResult::Fail;
}

}  // namespace

BridgeReport run_bridge_bench(const BridgeOptions& options) {
  BridgeReport report;
  report.machine = describe_machine();
  report.cycles = options.cycles;
  if (!report.machine.chosen) {
    report.troubles.emplace_back(kOneProcessor);
    return report;
  }
  const LoadMeter load{report.machine.chosen->cpus};
  {
    const FarProcess far{options.domain};
    measure(options, report);
  }
  report.steal = load.so_far().steal;
  if (auto trouble = steal_trouble(report.steal); !trouble.empty())
    report.troubles.push_back(std::move(trouble));
  report.result = result_of(report);
  return report;
}

}  // namespace rths::bench

// SPDX-License-Identifier: Apache-2.0
#include "monitor/laboratory.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/memmap/map.hpp>

namespace rths::test {
namespace {

constexpr std::uint32_t kExtra = 64;

memmap::Map map_with(const std::string& name, int words) {
  std::string text = fmt::format(R"(
ringmap = 1
[ring]
name = "{}"
version = 1
size_bytes = 65536
[nodes]
srmd = 1
xpc = 2
gateway_east = 3
operator = 200
)",
                                 name);
  const auto partition = [&](const char* part, const char* node, int offset, int longwords,
                             bool whole) {
    text += fmt::format(
        "[[partition]]\nname = \"{}\"\nnode = \"{}\"\noffset = {}\nlongwords = {}\n"
        "tear_group = {}\n",
        part, node, offset, longwords, whole);
  };
  const auto signal = [&](const std::string& word, int offset, const char* type, const char* unit,
                          const char* more = "") {
    text += fmt::format(
        "[[partition.signal]]\nname = \"{}\"\noffset = {}\ntype = \"{}\"\nunit = \"{}\"\n{}\n",
        word, offset, type, unit, more);
  };
  partition("monitor.xpc", "xpc", 0, 4, true);
  signal("pc.command.long", 0, "f32", "m");
  signal("displacement.out.long", 1, "f32", "m");
  signal("observer.force.long", 2, "f32", "N");
  signal("host.step", 3, "f32", "1");
  partition("monitor.srmd", "srmd", 16, 6, true);
  signal("safety.state", 16, "f32", "1", "event = true");
  signal("safety.trip", 17, "f32", "1", "event = true");
  signal("safety.axis", 18, "f32", "1");
  signal("safety.value", 19, "f32", "1");
  signal("safety.limit", 20, "f32", "1");
  signal("host.late_max", 21, "f32", "s");
  partition("tune.srmd", "operator", 32, 1, false);
  signal("gain", 32, "f32", "1", "initial = 1\nrange = [0.5, 2]\nevent = true");
  partition("gateway.east", "gateway_east", 48, 2, false);
  signal("age.srmd", 48, "f32", "s", "initial = 0.002");
  signal("delay.srmd", 49, "f32", "s", "initial = 0.0005");
  if (words > 0) partition("extra", "srmd", static_cast<int>(kExtra), words, false);
  for (int i = 0; i < words; ++i)
    signal(std::to_string(i), static_cast<int>(kExtra) + i, "f32", "m");
  return memmap::parse_map(text, "laboratory");
}

std::uint32_t word_of(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

}  // namespace

Laboratory::Laboratory(const std::string& ring, int words)
    : ring_{broker::Ring::create(ring, map_with("laboratory", words))},
      name_{ring},
      words_{words},
      thread_{[this] { run(); }} {}

Laboratory::~Laboratory() {
  ends_.store(true);
  thread_.join();
  broker::remove_ring(name_);
}

std::vector<double> Laboratory::durations() {
  const std::scoped_lock lock{mutex_};
  return std::exchange(durations_, {});
}

void Laboratory::run() {
  broker::Node machine = ring_.join("srmd", 0), controller = ring_.join("xpc", 0);
  const TearGroupId of_controller = ring_.tear_group("monitor.xpc");
  const TearGroupId of_machine = ring_.tear_group("monitor.srmd");
  std::array<std::uint32_t, 6> safety{word_of(2)};  // running
  WallClock clock;
  TimePoint next = clock.now();
  for (std::uint64_t step = 0; !ends_.load(); ++step) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(step) / 1000;
    const double command = 0.01 * std::sin(phase);
    const double gain = std::bit_cast<float>(controller.read(LongwordOffset{32}));
    const std::array<std::uint32_t, 4> words{word_of(command), word_of(command - 1e-4),
                                             word_of(gain * 1e5 * std::sin(phase)),
                                             word_of(static_cast<double>(step))};
    const TimePoint begun = clock.now();
    static_cast<void>(controller.write_group(of_controller, words));
    controller.beat();
    if (trips_.exchange(false))  // velocity of the command along the first axis
      safety = {word_of(3), word_of(3), word_of(0), word_of(2.1), word_of(1.8), 0};
    static_cast<void>(machine.write_group(of_machine, safety));
    for (int i = 0; i < words_; ++i)
      static_cast<void>(machine.write(LongwordOffset{kExtra + static_cast<std::uint32_t>(i)},
                                      word_of(std::sin(phase + i))));
    machine.beat();
    const double duration = to_seconds(clock.now() - begun);
    {
      constexpr std::size_t kMost = 100'000;
      const std::scoped_lock lock{mutex_};
      if (durations_.size() < kMost) durations_.push_back(duration);
    }
    steps_.store(step + 1);
    next += std::chrono::milliseconds{1};
    clock.sleep_until(next);
  }
}

}  // namespace rths::test

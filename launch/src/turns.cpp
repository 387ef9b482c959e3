// SPDX-License-Identifier: Apache-2.0
#include "turns.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "interrupt.hpp"

namespace rths::launch {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{100};

// A word of a turn: the number of steps in the upper 30 bits, 12 days at 1 kHz, and the end of the
// node in the lower two.
constexpr std::uint32_t kEndBits = 2;
enum TurnsEnd : std::uint32_t { kGoesOn, kDone, kFault };

std::uint32_t end_of(Status status) {
  if (status == Status::Done) return kDone;
  return status == Status::Fault ? kFault : kGoesOn;
}

std::vector<broker::LongwordRange> words_of(const memmap::Map& map, const Experiment& experiment) {
  std::vector<broker::LongwordRange> words;
  for (const auto& plan : experiment.nodes)
    for (const auto& partition : map.partitions())
      if (partition.name == turn_partition(plan.node)) words.push_back({partition.base, 1});
  return words;
}

// The status of a step by the word of its node; empty: not made yet. The other host is ahead if no
// step of this host comes in between.
std::optional<Status> status_of(std::uint32_t step, std::uint32_t word) {
  const std::uint32_t steps = word >> kEndBits, end = word & ((1U << kEndBits) - 1);
  if (steps < step) return std::nullopt;
  if (steps > step || end == kGoesOn) return Status::Ok;
  return end == kDone ? Status::Done : Status::Fault;
}

}  // namespace

Turns::Turns(broker::Ring& ring, const Experiment& experiment, HostLink& link)
    : reader_{ring.observe()},
      waiter_{ring.wait_for(words_of(ring.map(), experiment))},
      link_{link} {
  const auto words = words_of(ring.map(), experiment);
  for (std::size_t i = 0; i < words.size(); ++i)
    turns_[experiment.nodes[i].node] = {words[i].begin, 0};
}

Turns::Waited Turns::wait_for(const std::string& node) {
  const WallClock clock;
  Turn& turn = turns_.at(node);
  ++turn.steps;
  for (;;) {
    if (const auto status = status_of(turn.steps, reader_.read(turn.word))) return {status, ""};
    broker::Write ignored{};
    if (waiter_.wait(clock.now() + kLook, ignored) == Status::Ok) continue;
    if (InterruptGuard::is_interrupted()) return {{}, "interrupted"};
    if (InterruptGuard::is_stop_requested()) return {{}, "stopped on request"};
    if (const auto trouble = link_.find_trouble()) return {{}, *trouble};
  }
}

void Turns::pass_on(broker::Node& writer, const std::string& node, Status status) {
  Turn& turn = turns_.at(node);
  ++turn.steps;
  static_cast<void>(writer.write(turn.word, turn.steps << kEndBits | end_of(status)));
}

}  // namespace rths::launch

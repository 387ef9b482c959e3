// SPDX-License-Identifier: Apache-2.0
#include "image_state.hpp"

#include <atomic>
#include <bit>
#include <chrono>
#include <thread>

namespace rths::replicated {
namespace {

using std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds{1};
constexpr auto kPoll = std::chrono::milliseconds{1};
constexpr std::uint64_t kAsked = std::uint64_t{1} << 63U;

// Bit 63, kind in bits 40 to 47, node in bits 32 to 39, number below: a rate [-], a delay [ns] or
// an id.
std::uint64_t encode(const Action& action) {
  double number = action.value;
  if (action.kind == Action::Kind::BitErrorRate) number = action.rate;
  if (action.kind == Action::Kind::Delay) number = to_ns(action.delay);
  return kAsked | static_cast<std::uint64_t>(action.kind) << 40U |
         std::uint64_t{action.node & 0xFF} << 32U |
         std::bit_cast<std::uint32_t>(static_cast<float>(number));
}

std::optional<Action> decode(std::uint64_t word) {
  const auto kind = static_cast<std::uint32_t>(word >> 40U & 0xFF);
  const auto number = std::bit_cast<float>(static_cast<std::uint32_t>(word));
  if (kind > static_cast<std::uint32_t>(Action::Kind::Id) || !(number >= 0 && number <= 1e9F))
    return std::nullopt;
  Action action;
  action.kind = static_cast<Action::Kind>(kind);
  action.node = static_cast<std::uint32_t>(word >> 32U & 0xFF);
  action.value = static_cast<std::uint32_t>(number);
  action.rate = number;
  action.delay = from_ns(number);
  return action;
}

}  // namespace

FaultBox::FaultBox(const std::string& ring)
    : object_{broker::SharedObject::open(ring)}, page_{object_.map(0, broker::kPageBytes)} {}

void FaultBox::open() { std::atomic_ref{header().is_replicated}.store(1); }
bool FaultBox::is_open() const { return std::atomic_ref{header().is_replicated}.load() == 1; }

std::optional<Action> FaultBox::asked() const {
  const std::uint64_t word = std::atomic_ref{header().fault}.load();
  return (word & kAsked) == 0 ? std::nullopt : decode(word);
}

void FaultBox::confirm() { std::atomic_ref{header().fault}.store(0); }

bool FaultBox::ask(const Action& action) {
  const std::uint64_t word = encode(action);
  const auto deadline = steady_clock::now() + kPatience;
  std::atomic_ref fault{header().fault};
  for (std::uint64_t none = 0; !fault.compare_exchange_strong(none, word); none = 0) {
    if (steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kPoll);
  }
  while (fault.load() == word) {
    if (steady_clock::now() >= deadline) {
      confirm();
      return false;
    }
    std::this_thread::sleep_for(kPoll);
  }
  return true;
}

}  // namespace rths::replicated

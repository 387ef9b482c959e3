// SPDX-License-Identifier: Apache-2.0
#include "peer_watch.hpp"

#include <fmt/format.h>

namespace rths::launch {
namespace {

constexpr Duration kLongestSilence = std::chrono::milliseconds{500};  // beyond a peer's period

}  // namespace

PeerWatch::PeerWatch(const broker::Node& node, const memmap::Map& map, const Experiment& experiment,
                     const std::string& own_name)
    : node_{node}, own_{map.node(own_name)}, has_images_{experiment.cards.has_value()} {
  for (const auto& plan : experiment.nodes)
    if (plan.node != own_name)
      peers_.push_back({plan.node,
                        map.node(plan.node),
                        kLongestSilence + plan.schedule.period,
                        plan.settings.program.has_value(),
                        {}});
}

std::optional<std::string> PeerWatch::find_trouble(TimePoint now) {
  if (is_ring_lost()) return "memory of the ring was lost";
  const std::uint64_t own_beats = node_.beats_of(own_);
  const bool runs = own_beats != own_beats_;
  own_beats_ = own_beats;
  for (auto& peer : peers_) {
    const auto presence = node_.presence_of(peer.id);
    if (presence.state == broker::Presence::State::Vanished)
      return fmt::format("{} (process {}) vanished", peer.name, presence.pid);
    if (presence.state == broker::Presence::State::Absent || !runs) continue;  // left in order
    if (peer.is_foreign) continue;  // its own process judges its silence
    if (peer.silence.look(now, node_.beats_of(peer.id)) > peer.longest_silence)
      return has_images_ ? fmt::format("no messages of {} arrive", peer.name)
                         : fmt::format("{} (process {}) is silent", peer.name, presence.pid);
  }
  return std::nullopt;
}

}  // namespace rths::launch

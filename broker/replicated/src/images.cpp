// SPDX-License-Identifier: Apache-2.0
#include <rths/replicated/images.hpp>

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <rths/card/image_name.hpp>
#include <rths/card/monotonic_time.hpp>
#include <rths/core/error.hpp>

#include "image_state.hpp"

namespace rths::replicated {
namespace {

constexpr Time kPresencePeriod = std::chrono::milliseconds{5};

constexpr const char* kOperator = "operator";
constexpr std::uint32_t kMonitorId = 255;    // of the card that only receives, without an operator
constexpr std::uint32_t kReceiveOnly = 0x1;  // CSR0

using Presence = broker::Presence::State;

bool has_operator(const memmap::Map& map) {
  const auto& nodes = map.description().nodes;
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const auto& node) { return node.name == kOperator; });
}

RingSetup setup_of(const memmap::Map& map, const CardOptions& options) {
  RingSetup setup;
  setup.strict_ids = options.strict_ids;
  setup.bit_error_rate = options.bit_error_rate;
  setup.seed = options.seed;
  for (const auto& node : map.description().nodes)
    setup.nodes.push_back({.id = node.id.value(),
                           .fibre_m = options.fibre_m,
                           .memory_bytes = std::uint64_t{map.description().size_longwords} * 4});
  if (!has_operator(map))
    setup.nodes.push_back({.id = kMonitorId, .memory_bytes = setup.nodes[0].memory_bytes});
  return setup;
}

std::string in_words(const Action& action, const std::string& node) {
  switch (action.kind) {
    case Action::Kind::PowerOff:
      return fmt::format("{} out of the ring", node);
    case Action::Kind::PowerOn:
      return fmt::format("{} has power again", node);
    case Action::Kind::CutFibre:
      return fmt::format("fibre cut behind {}", node);
    case Action::Kind::RepairFibre:
      return fmt::format("fibre repaired behind {}", node);
    case Action::Kind::BitErrorRate:
      return fmt::format("bit error rate {:g}", action.rate);
    case Action::Kind::Delay:
      return fmt::format("{} delays messages by {:g} ns", node, to_ns(action.delay));
    default:
      return fmt::format("{} has id {}", node, action.value);
  }
}

}  // namespace

std::string image_name(const std::string& ring, const std::string& node) {
  return scramnet::image_name(ring, node);
}

Images::State::State(const memmap::Map& its_map, const CardOptions& its_options)
    : map{its_map}, options{its_options}, cards{setup_of(map, options)} {
  find_words();
  for (std::uint32_t at = 0; at < cards.nodes(); ++at) cards.card(at).write_csr(2, options.csr2);
  cards.observe([this](const Hop& hop) {
    if (hop.kind != Hop::Kind::Stored) return;
    if (hop.node != hop.origin || writes_last(hop.node)) arrive(hop);
  });
}

void Images::State::add_all(const std::function<broker::Ring(const std::string& node)>& make) {
  const bool needs_monitor = !has_operator(map);
  std::map<std::string, broker::Ring> rings;
  const auto is_rings_own = [](const std::string& node) {
    return node.empty() || node == kOperator;
  };
  // The ring's own name comes last, so that a process that finds it finds all images.
  for (const auto& node : map.description().nodes)
    if (!is_rings_own(node.name)) rings.emplace(node.name, make(node.name));
  const std::string last = needs_monitor ? "" : kOperator;
  rings.emplace(last, make(last));
  for (const auto& node : map.description().nodes) add(node.name, std::move(rings.at(node.name)));
  if (needs_monitor) add("", std::move(rings.at("")));
  for (std::uint32_t at = 0; at < images.size(); ++at)
    if (is_rings_own(images[at].node)) cards.card(at).write_csr(0, kReceiveOnly);
}

void Images::State::add(const std::string& node, broker::Ring ring) {
  auto carrier = ring.join_plain("");
  std::optional<broker::Follower> host;
  if (!node.empty()) host.emplace(ring.follow(node));
  images.push_back({node, std::move(ring), std::move(carrier), std::move(host)});
  images.back().others.resize(cards.nodes());
  images.back().received.resize(cards.nodes());
}

std::uint32_t Images::State::position(const std::string& node) const {
  const auto& nodes = map.description().nodes;
  const auto found = std::find_if(nodes.begin(), nodes.end(),
                                  [&](const auto& candidate) { return candidate.name == node; });
  if (found == nodes.end()) throw Error{fmt::format("the map has no node '{}'", node)};
  return static_cast<std::uint32_t>(found - nodes.begin());
}

// A card is inserted when its node first joins; it stays so without a process, as on hardware. A
// program that stores through a pointer inserts its card itself.
void Images::State::follow_presence() {
  for (std::uint32_t at = 0; at < images.size(); ++at)
    if (images[at].watch) look(at);
  for (std::uint32_t at = 0; at < map.description().nodes.size(); ++at) follow_presence(at);
}

void Images::State::follow_presence(std::uint32_t at) {
  Image& image = images[at];
  const auto state = image.carrier.presence_of(map.description().nodes[at].id).state;
  image.plain = image.watch && image.watch->is_plain(image.node);
  scramnet::Card* const shared = cards.engine_->nodes()[at].shared;
  if (!image.present && state == Presence::Alive) {
    image.present = true;
    if (shared == nullptr || shared->carried.plain_host.load() == 0)
      cards.card(at).write_csr(0, kOnRing);
  }
  // Its last writes are taken and arrive until the second look.
  image.absent_looks = state == Presence::Absent ? image.absent_looks + 1 : 0;
  if (!image.present || image.absent_looks < 2 || !is_drained(at)) return;
  image.present = false;
  if (shared != nullptr) shared->carried.plain_host.store(0);
  for (auto& other : images) other.others[at].reset();
}

bool Images::State::is_drained(std::uint32_t at) {
  const scramnet::Card* const shared = cards.engine_->nodes()[at].shared;
  const bool traps_are_taken = shared == nullptr || shared->carried.traps.taken.load() ==
                                                        shared->carried.traps.reserved.load();
  return traps_are_taken && images[at].waiting.empty() &&
         cards.card(at).report().transmit_fifo == 0;
}

// The registers of a named image's card are in its object, where its host finds them.
void Images::State::share_cards() {
  cards.engine_->set_clock(scramnet::now_ns());
  for (std::uint32_t at = 0; at < images.size(); ++at) {
    Image& image = images[at];
    const std::uint32_t id = cards.card(at).peek_csr(3) >> 8;
    auto& table = *tables.emplace_back(
        std::make_unique<scramnet::CardTable>(image.ring, image_name(name, images[at].node)));
    const auto index = table.take(scramnet::kNamed | id, broker::own_claim());
    const auto card = index ? table.at(*index) : std::nullopt;
    if (!card) throw Error{fmt::format("ring '{}' has no card", image_name(name, images[at].node))};
    const std::uint32_t csr0 = cards.card(at).peek_csr(0);
    cards.engine_->share(at, *card->card, card->acr, table.members());
    cards.card(at).write_csr(2, options.csr2);
    cards.card(at).write_csr(0, csr0);
    if (!image.node.empty()) image.watch = std::make_unique<broker::Watch>(image.ring);
  }
}

void Images::State::fail(Action action) {
  act(cards, action);
  events.push_back(fmt::format("{} at {:.3f} s", in_words(action, images[action.node].node),
                               to_ns(cards.now() - begin) * 1e-9));
}

// Those of the options, and those that another process asks for.
void Images::State::run_faults(Time now) {
  while (next_fault < options.faults.size()) {
    const Fault& fault = options.faults[next_fault];
    if (begin + fault.action.at > now) break;
    cards.run_until(std::max(cards.now(), begin + fault.action.at));
    Action action = fault.action;
    if (!fault.node.empty()) action.node = position(fault.node);
    fail(action);
    ++next_fault;
  }
  if (!box) return;
  const auto asked = box->asked();
  if (!asked) return;
  if (asked->node < images.size()) fail(*asked);
  box->confirm();
}

void Images::State::beat(std::uint32_t at) {
  Image& image = images[at];
  for (std::uint32_t other = 0; other < image.received.size(); ++other)
    if (std::exchange(image.received[other], 0) != 0 && image.others[other])
      image.others[other]->beat();
}

Images::Images(std::unique_ptr<State> state) : state_{std::move(state)} {}
Images::Images(Images&&) noexcept = default;
Images::~Images() = default;

Images Images::in_process(const memmap::Map& map, const CardOptions& options) {
  auto state = std::make_unique<State>(map, options);
  state->add_all([&](const std::string&) { return broker::Ring::in_process(map); });
  return Images{std::move(state)};
}

Images Images::create(const std::string& ring, const memmap::Map& map, const CardOptions& options) {
  auto state = std::make_unique<State>(map, options);
  state->name = ring;
  state->add_all([&](const std::string& node) {
    auto image = broker::Ring::create(image_name(ring, node), map);
    state->to_remove.push_back(image_name(ring, node));
    return image;
  });
  state->box.emplace(ring);
  state->box->open();
  state->share_cards();
  return Images{std::move(state)};
}

void request_fault(const std::string& ring, const Action& fault) {
  FaultBox box{ring};
  if (!box.is_open())
    throw Error{fmt::format("ring '{}' is shared, expected a replicated one", ring)};
  if (!box.ask(fault))
    throw Error{fmt::format("ring '{}': its cards do not answer; its run has ended", ring)};
}

broker::Ring& Images::of(const std::string& node) {
  return state_->images[state_->position(node)].ring;
}

void Images::advance(Time now) {
  State& state = *state_;
  state.run_faults(now);
  state.cards.run_until(now);
  if (now >= state.next_presence) {
    state.next_presence = now + kPresencePeriod;
    state.follow_presence();
  }
  for (std::uint32_t at = 0; at < state.images.size(); ++at) {
    state.cards.engine_->exchange(at);
    state.take_stores(at);
    state.beat(at);
  }
}

void Images::begin(Time origin) { state_->begin = origin; }
const std::vector<std::string>& Images::events() const { return state_->events; }
std::uint64_t Images::stalls() const { return state_->stalls; }

}  // namespace rths::replicated

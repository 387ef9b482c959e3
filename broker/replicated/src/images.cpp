// SPDX-License-Identifier: Apache-2.0
#include <rths/replicated/images.hpp>

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/watch.hpp>
#include <rths/core/error.hpp>

#include "card_table.hpp"
#include "engine.hpp"
#include "fault_box.hpp"
#include "image_name.hpp"
#include "monotonic_time.hpp"

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

// True if the process of a node stores through a pointer.
bool is_plain(const std::string& image, const std::string& node) {
  const auto report = broker::inspect_ring(image);
  return report &&
         std::any_of(report->occupants.begin(), report->occupants.end(), [&](const auto& occupant) {
           return occupant.alive && occupant.plain && occupant.node == node;
         });
}

}  // namespace

std::string image_name(const std::string& ring, const std::string& node) {
  return scramnet::image_name(ring, node);
}

struct Images::State {
  /// A word that nodes write: its owner, and its tear group.
  struct WordUse {
    std::uint32_t owner = kNone;  ///< position
    std::uint32_t group = kNone;
  };

  struct GroupUse {
    TearGroupId id;
    std::uint32_t base = 0, longwords = 0;
  };

  struct Store {
    std::uint32_t longword = 0, value = 0;
  };

  /// The memory of one node.
  struct Image {
    std::string node;
    broker::Ring ring;
    broker::Node observer;
    std::optional<broker::Follower> host;                  ///< writes of the node
    std::vector<std::optional<broker::Node>> others = {};  ///< on this image, by position
    std::vector<char> heard = {};                          ///< by position: since the last beat
    std::deque<Store> waiting = {};                        ///< for space in the transmit FIFO
    std::unique_ptr<broker::Watch> watch =
        nullptr;           ///< finds stores through pointers; of named images
    bool plain = false;    ///< its node stores through a pointer
    int absent_looks = 0;  ///< in a row
    bool present = false;  ///< its card was inserted, its node has not left
  };

  State(const memmap::Map& its_map, const CardOptions& its_options)
      : map{its_map}, options{its_options}, cards{setup_of(map, options)} {
    find_words();
    for (std::uint32_t at = 0; at < cards.nodes(); ++at) cards.card(at).write_csr(2, options.csr2);
    cards.observe([this](const Hop& hop) {
      if (hop.kind == Hop::Kind::Stored && hop.node != hop.origin) arrive(hop);
    });
  }
  ~State() {
    for (const auto& name : names) broker::remove_ring(name);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // The ring's own name comes last, so that a process that finds it finds all images.
  template <class Make>
  void add_all(Make make) {
    for (const auto& node : map.description().nodes) add(node.name, make(node.name));
    if (!has_operator(map)) add("", make(""));
    for (std::uint32_t at = 0; at < images.size(); ++at)
      if (images[at].node.empty() || images[at].node == kOperator)
        cards.card(at).write_csr(0, kReceiveOnly);
  }
  void add(const std::string& node, broker::Ring ring) {
    auto observer = ring.observe();
    std::optional<broker::Follower> host;
    if (!node.empty()) host.emplace(ring.follow(node));
    images.push_back({node, std::move(ring), std::move(observer), std::move(host)});
    images.back().others.resize(cards.nodes());
    images.back().heard.resize(cards.nodes());
  }

  [[nodiscard]] std::uint32_t position(const std::string& node) const {
    const auto& nodes = map.description().nodes;
    const auto found = std::find_if(nodes.begin(), nodes.end(),
                                    [&](const auto& candidate) { return candidate.name == node; });
    if (found == nodes.end()) throw Error{fmt::format("the map has no node '{}'", node)};
    return static_cast<std::uint32_t>(found - nodes.begin());
  }

  void find_words();
  void follow_presence();
  [[nodiscard]] bool is_drained(std::uint32_t at);
  void take_stores(std::uint32_t at);
  void store(std::uint32_t at, Store store);
  [[nodiscard]] Access write(std::uint32_t at, Store store);
  [[nodiscard]] std::uint64_t window(std::uint32_t at);  ///< [B]
  void share_cards();
  void flush(std::uint32_t at);
  void arrive(const Hop& hop);
  void arrive(std::uint32_t at, std::uint32_t origin, std::uint32_t longword, std::uint32_t value);
  [[nodiscard]] broker::Node* stand_in(std::uint32_t at, std::uint32_t origin);
  void fail(Action action);
  void run_faults(Time now);
  void beat(std::uint32_t at);

  memmap::Map map;
  CardOptions options;
  std::vector<std::unique_ptr<scramnet::CardTable>> tables;  ///< of named images
  Ring cards;
  std::optional<FaultBox> box;     ///< of named images
  std::vector<std::string> names;  ///< of the images, by position; to be removed
  std::vector<Image> images;       ///< by position
  std::vector<WordUse> words;
  std::vector<GroupUse> groups;
  std::vector<std::uint32_t> group_words;  ///< scratch
  std::vector<std::string> events;
  std::size_t next_fault = 0;
  Time begin{0}, next_presence{0};
  std::uint64_t stalls = 0;
};

void Images::State::find_words() {
  for (const auto& partition : map.partitions()) {
    const std::uint32_t base = partition.base.value();
    words.resize(std::max<std::size_t>(words.size(), base + partition.longwords));
    WordUse use{position(partition.node), kNone};
    if (partition.tear_group) {
      use.group = static_cast<std::uint32_t>(groups.size());
      groups.push_back({TearGroupId{use.group}, base, partition.longwords});
    }
    std::fill_n(words.begin() + base, partition.longwords, use);
  }
}

// A card is inserted when its node first joins; it stays so without a process, as on hardware. A
// program that stores through a pointer inserts its card itself.
void Images::State::follow_presence() {
  for (auto& image : images)
    if (image.watch) static_cast<void>(image.watch->look());
  for (std::uint32_t at = 0; at < map.description().nodes.size(); ++at) {
    Image& image = images[at];
    const auto state = image.observer.presence_of(map.description().nodes[at].id).state;
    if (state == Presence::Alive && !image.present) {
      image.present = true;
      image.plain = image.watch && is_plain(names[at], image.node);
      if (!image.plain) cards.card(at).write_csr(0, kOnRing);
    }
    // Its last writes are taken and arrive until the second look.
    image.absent_looks = state == Presence::Absent ? image.absent_looks + 1 : 0;
    if (!image.present || image.absent_looks < 2 || !is_drained(at)) continue;
    image.present = false;
    for (auto& other : images) other.others[at].reset();
  }
}

bool Images::State::is_drained(std::uint32_t at) {
  return images[at].waiting.empty() && cards.card(at).report().transmit_fifo == 0;
}

void Images::State::take_stores(std::uint32_t at) {
  Image& image = images[at];
  if (!image.host) return;
  if (image.plain) static_cast<void>(image.watch->look());
  flush(at);
  broker::Write write;
  for (;;) {
    const auto followed = image.host->next(write);
    if (followed == broker::Followed::Nothing) return;
    if (followed == broker::Followed::Lost) {
      events.push_back(fmt::format("{}: writes were lost before the cards took them", image.node));
      continue;
    }
    const std::uint32_t longword = write.offset.value();
    if (write.group.empty()) {
      store(at, {longword, write.value});
      continue;
    }
    for (std::uint32_t i = 0; i < write.group.size(); ++i)
      store(at, {longword + i, write.group[i]});
  }
}

// The image has the addresses of the ring; the card's window may be a page of it.
Access Images::State::write(std::uint32_t at, Store store) {
  const std::uint64_t begin_of_window = window(at);
  const std::uint64_t offset = std::uint64_t{store.longword} * 4;
  if (offset < begin_of_window) return Access::Local;
  return cards.card(at).write(ByteOffset{static_cast<std::uint32_t>(offset - begin_of_window)},
                              store.value);
}

std::uint64_t Images::State::window(std::uint32_t at) {
  return scramnet::network_offset(cards.card(at).peek_csr(12));
}

void Images::State::store(std::uint32_t at, Store store) {
  images[at].waiting.push_back(store);
  flush(at);
}

// A host that is held off on hardware repeats its access; here its later writes wait.
void Images::State::flush(std::uint32_t at) {
  auto& waiting = images[at].waiting;
  while (!waiting.empty()) {
    const Store store = waiting.front();
    const auto access = write(at, store);
    if (access == Access::HeldOff) {
      ++stalls;
      return;
    }
    waiting.pop_front();
  }
}

void Images::State::arrive(const Hop& hop) {
  const Node& card = cards.engine_->nodes()[hop.node];
  const std::uint64_t begin_of_window = window(hop.node);
  for (std::uint32_t i = 0; i < hop.longwords; ++i) {
    const std::uint64_t address = hop.address.value() + std::uint64_t{4} * i;
    const std::uint64_t offset = address - begin_of_window;
    if (address < begin_of_window || offset >= card.memory.size()) continue;
    arrive(hop.node, hop.origin, static_cast<std::uint32_t>(address / 4),
           card.memory.get<std::uint32_t>(offset));
  }
}

void Images::State::arrive(std::uint32_t at, std::uint32_t origin, std::uint32_t longword,
                           std::uint32_t value) {
  Image& image = images[at];
  if (longword >= words.size() || words[longword].owner != origin) return;
  broker::Node* const node = stand_in(at, origin);
  if (node == nullptr) return;
  image.heard[origin] = 1;
  if (words[longword].group == kNone) {
    static_cast<void>(node->write(LongwordOffset{longword}, value));
    return;
  }
  const GroupUse& group = groups[words[longword].group];
  if (longword + 1 != group.base + group.longwords) return;
  const SparseBytes& memory = cards.engine_->nodes()[at].memory;
  group_words.clear();
  for (std::uint32_t i = 0; i < group.longwords; ++i)
    group_words.push_back(
        memory.get<std::uint32_t>((group.base + i) * std::uint64_t{4} - window(at)));
  static_cast<void>(node->write_group(group.id, group_words));
}

broker::Node* Images::State::stand_in(std::uint32_t at, std::uint32_t origin) {
  auto& node = images[at].others[origin];
  if (!node && images[origin].present) node.emplace(images[at].ring.join(images[origin].node, 0));
  return node ? &*node : nullptr;
}

// The registers of a named image's card are in its object, where its host finds them.
void Images::State::share_cards() {
  cards.engine_->set_clock(scramnet::now_ns());
  for (std::uint32_t at = 0; at < images.size(); ++at) {
    Image& image = images[at];
    const std::uint32_t id = cards.card(at).peek_csr(3) >> 8;
    auto& table =
        *tables.emplace_back(std::make_unique<scramnet::CardTable>(image.ring, names[at]));
    const auto index = table.take(scramnet::kNamed | id, broker::own_claim());
    const auto card = index ? table.at(*index) : std::nullopt;
    if (!card) throw Error{fmt::format("ring '{}' has no card", names[at])};
    const std::uint32_t csr0 = cards.card(at).peek_csr(0);
    cards.engine_->share(at, *card->card, card->acr);
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
  for (std::uint32_t other = 0; other < image.heard.size(); ++other)
    if (std::exchange(image.heard[other], 0) != 0 && image.others[other])
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
  state->add_all([&](const std::string& node) {
    const std::string name = image_name(ring, node);
    auto image = broker::Ring::create(name, map);
    state->names.push_back(name);
    return image;
  });
  state->share_cards();
  state->box.emplace(ring);
  state->box->open();
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

// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/look.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/broker/watch_text.hpp>
#include <rths/controller/safety.hpp>
#include <rths/core/axis.hpp>
#include <rths/memmap/units.hpp>

namespace rths::monitor {
namespace {

/// Writes are placed in their slot if the heartbeat that dates them comes within this time.
constexpr Duration kLongestBeat = std::chrono::milliseconds{20};
/// A node whose writes have had no date for this time does not beat.
constexpr Duration kNoBeat = std::chrono::milliseconds{100};
constexpr Duration kRateWindow = std::chrono::seconds{1};
constexpr Duration kNodesEvery = std::chrono::milliseconds{100};
constexpr double kOneLine = 10;  // changes of a word within this time [s]
constexpr std::size_t kMostEvents = 50;
constexpr std::size_t kMostViolations = 100;
constexpr std::string_view kOperator = "operator";  // writes the parameters of a run
constexpr std::string_view kStateWord = ".safety.state";

Slot slot_of(TimePoint time) { return time / kSlot; }

std::string state_text(float state) {
  if (!(state >= 0 && state < controller::kSafetyStates)) return "unknown";
  return to_text(static_cast<controller::SafetyState>(state));
}

// The counters of the host do not end a list of events.
bool is_worth_an_event(const WordState& word) {
  return word.is_event && word.name.find(".host.") == std::string::npos;
}

}  // namespace

RingLook::RingLook(const std::string& ring, std::size_t history_bytes)
    : name_{ring},
      ring_{broker::Ring::look_at(ring)},
      observer_{ring_.observe()},
      watch_{ring_, broker::Journalling::None},
      begun_{WallClock{}.now()},
      updated_{begun_},
      slot_{slot_of(begun_)} {
  word_at_.resize(map().description().size_longwords);
  for (const auto& entry : map().signals()) {
    const memmap::Signal& signal = *entry.signal;
    by_name_[entry.name] = words_.size();
    words_.push_back({entry.name, entry.partition->node, memmap::parse_unit(signal.unit).si,
                      memmap::Codec{signal}, signal.offset, entry.partition->node == kOperator,
                      signal.event});
    words_.back().value =
        static_cast<float>(words_.back().codec.decode(observer_.read(signal.offset)));
    word_at_[signal.offset.value()] = static_cast<std::uint32_t>(words_.size());
  }
  if (history_bytes > 0) history_.emplace(words_.size(), history_bytes, slot_);
  for (const auto& node : map().description().nodes) {
    members_.push_back({node.id, ring_.follow(node.name)});
    nodes_.emplace_back();
    nodes_.back().name = node.name;
    nodes_.back().presence = observer_.presence_of(node.id);
  }
  extents_.resize(words_.size());
}

bool RingLook::is_current() const { return !observer_.is_ring_lost() && ring_.is_current(); }

std::optional<std::size_t> RingLook::find(const std::string& name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? std::nullopt : std::optional{found->second};
}

std::optional<double> RingLook::value(const std::string& name) const {
  const auto found = find(name);
  return found ? std::optional<double>{words_[*found].value} : std::nullopt;
}

void RingLook::take_word(LongwordOffset offset, std::uint32_t bits, TimePoint time) {
  if (offset.value() >= word_at_.size() || word_at_[offset.value()] == 0) return;
  const std::size_t i = word_at_[offset.value()] - 1;
  WordState& word = words_[i];
  const float before = word.value;
  word.value = static_cast<float>(word.codec.decode(bits));
  word.written = time;
  extents_[i].add(word.value);
  if (word.value != before && is_worth_an_event(word)) note_change(word, before);
}

void RingLook::take(const broker::Write& write, Member& member, TimePoint time) {
  ++member.written;
  member.last_write = time;
  if (write.group.empty()) return take_word(write.offset, write.value, time);
  for (std::uint32_t i = 0; i < write.group.size(); ++i)
    take_word(advance(write.offset, i), write.group[i], time);
  note_trips();
}

// Words that no journal has: those of a plain client, and after a loss.
void RingLook::read_memory(const std::string& node) {
  for (const auto& word : words_) {
    if (word.node != node) continue;
    const std::uint32_t bits = observer_.read(word.offset);
    if (static_cast<float>(word.codec.decode(bits)) != word.value)
      take_word(word.offset, bits, updated_);
  }
}

void RingLook::read_slot(TimePoint end) {
  for (std::size_t i = 0; i < words_.size(); ++i) extents_[i] = {words_[i].value, words_[i].value};
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    broker::Write write;
    const bool has_no_beat = updated_ - std::max(member.last_write, begun_) > kNoBeat;
    broker::Followed followed{};
    do {
      followed = has_no_beat ? member.follower.next(write) : member.follower.next_until(end, write);
      if (followed == broker::Followed::Write) take(write, member, end);
    } while (followed == broker::Followed::Write);
    if (followed == broker::Followed::Lost) read_memory(nodes_[i].name);
  }
  if (history_) history_->append(extents_);
}

void RingLook::update() {
  updated_ = WallClock{}.now();
  if (updated_ - nodes_updated_ >= kNodesEvery) update_nodes();
  for (const auto& node : nodes_)
    if (node.is_plain) read_memory(node.name);
  for (const Slot until = slot_of(updated_ - kLongestBeat); slot_ < until; ++slot_)
    read_slot((slot_ + 1) * kSlot);
  look_for_violations();
}

void RingLook::update_rates(Member& member, NodeState& node) {
  auto& counts = member.counts;
  const std::uint64_t beats = observer_.beats_of(member.id);
  if (!counts.empty() && beats < counts.back().beats) counts.clear();  // joined again
  counts.push_back({updated_, beats, member.written});
  while (counts.size() > 2 && updated_ - counts[1].time >= kRateWindow) counts.pop_front();
  const double seconds = to_seconds(updated_ - counts.front().time);
  if (seconds <= 0) return;
  node.rate = static_cast<double>(beats - counts.front().beats) / seconds;
  node.writes = static_cast<double>(member.written - counts.front().writes) / seconds;
}

void RingLook::update_nodes() {
  nodes_updated_ = updated_;
  const auto occupants = ring_.report().occupants;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    NodeState& node = nodes_[i];
    using State = broker::Presence::State;
    const auto before = node.presence.state;
    node.presence = observer_.presence_of(member.id);
    if (node.presence.state != before && node.name != kOperator)
      add_event(node.name + (node.presence.state == State::Alive      ? " joined the ring"
                             : node.presence.state == State::Vanished ? " ended without leaving"
                                                                      : " left the ring"),
                node.presence.state == State::Vanished);
    node.is_plain = std::any_of(occupants.begin(), occupants.end(), [&](const auto& occupant) {
      return occupant.plain && occupant.node == node.name;
    });
    node.age = member.last_write.count() == 0
                   ? std::nullopt
                   : std::optional{to_seconds(slot_ * kSlot - member.last_write)};
    node.lost = member.follower.lost();
    update_rates(member, node);
    const std::string host = "monitor." + node.name + ".host.";
    node.steps = value(host + "step");
    node.late = value(host + "late");
    node.late_max = value(host + "late_max");
    node.duration = value(host + "duration");
    node.overruns = value(host + "overruns");
    node.stale = value(host + "stale");
  }
}

void RingLook::look_for_violations() {
  for (const auto& store : watch_.look()) {
    if (store.owner.empty()) continue;
    const std::string name = broker::word_name(map(), store.offset);
    if (violations_.size() >= kMostViolations && !violations_.contains(name)) continue;
    Violation& found = violations_[name];
    found.value = broker::word_value(map(), store.offset, store.value);
    if (++found.count > 1) continue;
    found.word = name;
    found.owner = store.owner;
    found.writers = broker::writers_of(store);
    found.time = to_seconds(store.seen - begun_);
    add_event(fmt::format("{} of {} was stored by {}", name, store.owner, found.writers), true);
  }
}

void RingLook::add_event(std::string text, bool is_bad) {
  events_.push_back({++event_count_, to_seconds(updated_ - begun_), std::move(text), is_bad});
  if (events_.size() > kMostEvents) events_.pop_front();
}

void RingLook::note_change(const WordState& word, float before) {
  if (word.name.ends_with(kStateWord))
    return add_event(fmt::format("safety layer of {}: {}", word.node, state_text(word.value)),
                     false);
  if (word.name.ends_with(".safety.trip")) {
    if (word.value == 0) return;
    trips_.push_back(&word);  // the words behind it belong to the same write
    return;
  }
  add_change(word, before);
}

// A word that changes often has one line with its first and last value.
void RingLook::add_change(const WordState& word, float before) {
  const double now = to_seconds(updated_ - begun_);
  const auto last = std::find_if(events_.rbegin(), events_.rend(),
                                 [&](const RingEvent& event) { return event.word == word.name; });
  const bool continues = last != events_.rend() && now - last->time < kOneLine;
  const float from = continues ? last->from : before;
  if (continues) events_.erase(std::next(last).base());
  add_event(fmt::format("{}: {:.6g} to {:.6g}{}{}", word.name, from, word.value,
                        word.unit == "1" ? "" : " ", word.unit == "1" ? "" : word.unit),
            false);
  events_.back().word = word.name;
  events_.back().from = from;
}

void RingLook::note_trips() {
  for (const WordState* trip : trips_)
    add_event(fmt::format("safety layer of {} tripped: {}", trip->node,
                          trip_text(trip->name.substr(0, trip->name.rfind('.') + 1))),
              true);
  trips_.clear();
}

std::string RingLook::trip_text(const std::string& prefix) const {
  const auto cause = value(prefix + "trip").value_or(0);
  if (!(cause > 0 && cause < controller::kSafetyCauses)) return "";
  const auto [quantity, unit] = to_text(static_cast<controller::SafetyCause>(cause));
  const double found = value(prefix + "value").value_or(0);
  const double limit = value(prefix + "limit").value_or(0);
  const bool is_of_node = cause >= static_cast<double>(controller::SafetyCause::NodeSilent);
  const auto axis = static_cast<std::size_t>(value(prefix + "axis").value_or(0));
  const std::string where = is_of_node || axis >= kTranslations.size()
                                ? ""
                                : fmt::format("{}: ", name_of(kTranslations[axis]));
  if (limit > 0)
    return fmt::format("{}{} is {:.4g} {}, expected at most {:.4g} {}", where, quantity, found,
                       unit, limit, unit);
  return fmt::format("{}{} is {:.4g}", where, quantity, found);
}

std::vector<SafetyReport> RingLook::safety() const {
  std::vector<SafetyReport> layers;
  for (const auto& word : words_) {
    if (!word.name.ends_with(kStateWord)) continue;
    const std::string prefix =
        word.name.substr(0, word.name.size() - kStateWord.size()) + ".safety.";
    layers.push_back({word.node, state_text(word.value), trip_text(prefix)});
  }
  return layers;
}

}  // namespace rths::monitor

// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/play.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/recording/recorded_words.hpp>

namespace rths::testkit {
namespace {

using recording::RecordedWord;

constexpr Duration kLongestSpin = std::chrono::microseconds{400};  // before a row: exact
constexpr Duration kLongestSleep = std::chrono::milliseconds{50};  // between looks for an interrupt
constexpr Duration kAwaitedLook = std::chrono::milliseconds{5};
constexpr Duration kTickLook = std::chrono::microseconds{50};

// "key=value key=value" as a table. A value that is a number is one.
Config table_of(const std::string& fault) {
  Config table = Config::parse("", "");
  for (const auto word : cells_of(fault, ' ')) {
    const auto pair = key_value(std::string{word});
    if (!pair) throw Error{fmt::format("fault '{}': expected key=value, found '{}'", fault, word)};
    if (const auto number = number_of(pair->second))
      table.set(pair->first, fmt::format("{}", *number));
    else
      table.put(pair->first, pair->second);
  }
  return table;
}

recording::MessageFault fault_of(const std::string& text, const memmap::Map& map) {
  const Config table = table_of(text);
  try {
    return recording::read_message_fault(table, map);
  } catch (const Error& error) {
    // Without its place in a file: there is none.
    const std::string message = error.what();
    throw Error{fmt::format("fault '{}': {}", text, message.substr(message.find(": ") + 2))};
  }
}

bool is_monitor(const memmap::Partition& partition) {
  return partition.name.starts_with("monitor.");
}

bool is_same(const memmap::SignalEntry& a, const memmap::SignalEntry& b) {
  return a.signal->type == b.signal->type && a.signal->unit == b.signal->unit &&
         a.partition->node == b.partition->node &&
         a.partition->tear_group == b.partition->tear_group;
}

/// A word of the ring, or a tear group with all its words that are played.
struct PlayedGroup {
  LongwordOffset base;
  std::optional<TearGroupId> id;  ///< empty: a single word
  struct Word {
    const std::vector<std::uint32_t>* words;  ///< row by row
    std::uint32_t at;                         ///< in the image
  };
  std::vector<Word> words;
  std::vector<std::uint32_t> image;

  /// Whether the row has another value of any word.
  [[nodiscard]] bool take(std::size_t row) {
    bool has_changed = row == 0;
    for (const auto& [values, at] : words) {
      has_changed = has_changed || image[at] != (*values)[row];
      image[at] = (*values)[row];
    }
    return has_changed;
  }
};

/// A recorded node on the ring.
class PlayedNode {
 public:
  PlayedNode(broker::Ring& ring, const std::string& name, std::vector<RecordedWord> words)
      : words_{std::move(words)}, node_{ring.join(name, 0)} {
    for (const auto& word : words_) add(ring, word);
  }
  PlayedNode(const PlayedNode&) = delete;
  PlayedNode& operator=(const PlayedNode&) = delete;

  /// @returns writes
  std::uint64_t write(std::size_t row) {
    std::uint64_t writes = 0;
    for (auto& group : groups_) {
      if (!group.take(row)) continue;
      const Status status = group.id ? node_.write_group(*group.id, group.image)
                                     : node_.write(group.base, group.image[0]);
      if (status != Status::Ok)
        throw Error{fmt::format("the ring refused a write to longword {}", group.base.value())};
      ++writes;
    }
    node_.beat();
    return writes;
  }

 private:
  void add(broker::Ring& ring, const RecordedWord& word) {
    const auto& entry = ring.map().entry(ring.map().signal(word.entry.name));
    const auto& partition = *entry.partition;
    const LongwordOffset offset = entry.signal->offset;
    if (!partition.tear_group) {
      groups_.push_back({offset, std::nullopt, {{&word.words, 0}}, {0}});
      return;
    }
    for (auto& group : groups_)
      if (group.id && group.base == partition.base)
        return group.words.push_back({&word.words, offset.value() - partition.base.value()});
    groups_.push_back({partition.base,
                       ring.tear_group(partition.name),
                       {{&word.words, offset.value() - partition.base.value()}},
                       std::vector<std::uint32_t>(partition.longwords)});
    static_cast<void>(node_.read_group(*groups_.back().id, groups_.back().image));
  }

  std::vector<RecordedWord> words_;
  broker::Node node_;
  std::vector<PlayedGroup> groups_;
};

/// A ring that is there, or one of its own.
class PlayRing {
 public:
  PlayRing(const std::string& name, const memmap::Map& map)
      : name_{name},
        is_own_{!is_in_use(name)},
        ring_{is_own_ ? broker::Ring::create(name, map) : broker::Ring::attach(name)} {}
  ~PlayRing() {
    if (is_own_) broker::remove_ring(name_);
  }
  PlayRing(const PlayRing&) = delete;
  PlayRing& operator=(const PlayRing&) = delete;
  [[nodiscard]] broker::Ring& ring() { return ring_; }

 private:
  static bool is_in_use(const std::string& name) {
    const auto report = broker::inspect_ring(name);
    return report && report->in_use();
  }

  std::string name_;
  bool is_own_;
  broker::Ring ring_;
};

// The words that the ring has, too. Monitors differ from run to run, the laboratory's words do not.
std::vector<RecordedWord> on_ring(std::vector<RecordedWord> words, const broker::Ring& ring,
                                  const std::string& name) {
  std::erase_if(words, [&](const RecordedWord& word) {
    const auto found = ring.map().find_signal(word.entry.name);
    if (found && is_same(word.entry, ring.map().entry(*found))) return false;
    if (!is_monitor(*word.entry.partition))
      throw Error{fmt::format(
          "ring '{}' has the map '{}', in which '{}' is {}, expected that of the recording", name,
          ring.map().description().name, word.entry.name, found ? "another word" : "no word")};
    return true;
  });
  return words;
}

std::vector<std::vector<RecordedWord>> words_with_faults(const PlaySettings& settings,
                                                         const recording::Reader& run) {
  std::vector<std::vector<RecordedWord>> all;
  for (const auto& node : settings.nodes)
    all.push_back(
        recording::of_file(settings.recording, [&] { return recording::words_of(run, node); }));
  for (const auto& text : settings.faults) {
    const auto fault = fault_of(text, run.map());
    const auto found = std::find(settings.nodes.begin(), settings.nodes.end(), fault.node);
    if (found == settings.nodes.end())
      throw Error{fmt::format("fault '{}': node '{}' is not played", text, fault.node)};
    recording::apply(fault, run.time(),
                     all[static_cast<std::size_t>(found - settings.nodes.begin())]);
  }
  return all;
}

void wait_for(const PlaySettings& settings, broker::Ring& ring,
              const std::function<bool()>& is_interrupted) {
  WallClock clock;
  const TimePoint latest = clock.now() + from_seconds(settings.longest_wait);
  const broker::Node observer = ring.observe();
  for (const auto& node : settings.awaited) {
    const NodeId id = ring.map().node(node);
    while (observer.presence_of(id).state != broker::Presence::State::Alive) {
      if (is_interrupted()) return;
      if (clock.now() > latest)
        throw Error{fmt::format("node '{}' was not on ring '{}' within {:g} s", node, settings.ring,
                                settings.longest_wait)};
      clock.sleep_until(clock.now() + kAwaitedLook);
    }
  }
}

// Exact to the clock, as far as the host lets this thread run. A single processor is left to the
// readers. @returns whether to go on
bool wait_until(TimePoint due, WallClock& clock, const std::function<bool()>& is_interrupted) {
  static const Duration spin = std::thread::hardware_concurrency() > 1 ? kLongestSpin : Duration{0};
  for (TimePoint now = clock.now(); now < due - spin; now = clock.now()) {
    if (is_interrupted()) return false;
    clock.sleep_until(std::min(due - spin, now + kLongestSleep));
  }
  while (clock.now() < due) continue;  // at most kLongestSpin
  return !is_interrupted();
}

Played play_by_clock(const PlaySettings& settings, const std::vector<double>& time,
                     std::deque<PlayedNode>& nodes, const std::function<bool()>& is_interrupted) {
  Played played;
  played.gap_errors.reserve(time.size());
  WallClock clock;
  const TimePoint begun = clock.now() + kLongestSpin;
  TimePoint last{0};
  for (std::size_t row = 0; row < time.size(); ++row) {
    const double since = settings.rate * (time[row] - time.front());
    if (!wait_until(begun + from_seconds(since), clock, is_interrupted)) return played;
    const TimePoint now = clock.now();
    for (auto& node : nodes) played.writes += node.write(row);
    if (row > 0) {
      const double gap = settings.rate * (time[row] - time[row - 1]);
      played.gap_errors.push_back(std::abs(to_seconds(now - last) - gap) / gap);
    }
    last = now;
  }
  played.is_complete = true;
  return played;
}

// Ticks of the counter's node after which each row is written: the next tick reads it. A row
// between two ticks has what the later one had read. A recording with a row for each tick has it in
// the row of this tick, which was taken after it.
std::vector<double> ticks_before_rows(const std::vector<double>& counter) {
  std::vector<double> ticks;
  std::size_t changes = 0;
  for (const double count : counter) {
    const double before = ticks.empty() ? 0 : ticks.back();
    ticks.push_back(std::isfinite(count) ? std::max(before, std::round(count)) : before);
    changes += ticks.back() > before ? 1 : 0;
  }
  const bool has_rows_between = 2 * ticks.size() > 3 * changes;
  for (double& tick : ticks) tick = std::max(0.0, tick - (has_rows_between ? 0 : 1));
  const double first = ticks.empty() ? 0 : ticks.front();
  for (double& tick : ticks) tick -= first;
  return ticks;
}

/// A counter that another node writes, from its value now on.
class Counter {
 public:
  Counter(broker::Ring& ring, const PlaySettings& settings)
      : settings_{settings},
        entry_{ring.map().entry(ring.map().signal(settings.counter))},
        codec_{*entry_.signal},
        observer_{ring.observe()} {
    for (const auto& node : settings.nodes)
      if (node == entry_.partition->node)
        throw Error{fmt::format("counter '{}' is written by node '{}', which is played",
                                settings.counter, node)};
    begun_ = now();
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;

  [[nodiscard]] double ticks() const { return now() - begun_; }
  /// @returns whether to go on
  bool wait_until(double ticks, const std::function<bool()>& is_interrupted) {
    const TimePoint latest = clock_.now() + from_seconds(settings_.longest_wait);
    while (this->ticks() < ticks && !is_interrupted()) {
      if (clock_.now() > latest)
        throw Error{fmt::format("counter '{}' of ring '{}' is {:g}, expected {:g} within {:g} s",
                                settings_.counter, settings_.ring, now(), begun_ + ticks,
                                settings_.longest_wait)};
      clock_.sleep_until(clock_.now() + kTickLook);
    }
    return !is_interrupted();
  }

 private:
  [[nodiscard]] double now() const {
    return std::round(codec_.decode(observer_.read(entry_.signal->offset)));
  }

  const PlaySettings& settings_;
  memmap::SignalEntry entry_;
  memmap::Codec codec_;
  broker::Node observer_;
  WallClock clock_;
  double begun_ = 0;
};

Played play_by_counter(const PlaySettings& settings, const recording::Reader& run,
                       broker::Ring& ring, std::deque<PlayedNode>& nodes,
                       const std::function<bool()>& is_interrupted) {
  const auto ticks = ticks_before_rows(run.signal(settings.counter));
  Counter counter{ring, settings};
  Played played;
  for (std::size_t row = 0; row < ticks.size(); ++row) {
    if (!counter.wait_until(ticks[row], is_interrupted)) return played;
    for (auto& node : nodes) played.writes += node.write(row);
    const bool is_last_before_tick = row + 1 == ticks.size() || ticks[row + 1] > ticks[row];
    if (!is_last_before_tick) continue;
    ++played.ticks;
    played.late_ticks += counter.ticks() > ticks[row] ? 1 : 0;
  }
  played.is_complete = true;
  return played;
}

}  // namespace

Played play(const PlaySettings& settings, const std::function<bool()>& is_interrupted) {
  if (recording::is_being_written(settings.recording))
    throw Error{settings.recording.string() + ": is still written, expected a finished recording"};
  const recording::Reader run{settings.recording};
  auto words = words_with_faults(settings, run);
  PlayRing ring{settings.ring, run.map()};
  for (auto& one : words) one = on_ring(std::move(one), ring.ring(), settings.ring);
  std::deque<PlayedNode> nodes;
  for (std::size_t i = 0; i < words.size(); ++i)
    nodes.emplace_back(ring.ring(), settings.nodes[i], std::move(words[i]));
  wait_for(settings, ring.ring(), is_interrupted);
  return settings.counter.empty()
             ? play_by_clock(settings, run.time(), nodes, is_interrupted)
             : play_by_counter(settings, run, ring.ring(), nodes, is_interrupted);
}

}  // namespace rths::testkit

// SPDX-License-Identifier: Apache-2.0
#include "link.hpp"

#include <algorithm>
#include <deque>
#include <optional>

#include <fmt/format.h>

#include <rths/broker/watch.hpp>
#include <rths/core/error.hpp>

namespace rths::testkit {
namespace {

using State = broker::Presence::State;

constexpr Duration kLinkLook = std::chrono::milliseconds{2};     // at presence and heartbeats
constexpr Duration kPlainLook = std::chrono::microseconds{200};  // at stores through pointers

std::vector<broker::LongwordRange> words_of(const memmap::Map& map, const std::string& node,
                                            bool own) {
  std::vector<broker::LongwordRange> words;
  for (const auto& partition : map.partitions())
    if ((partition.node == node) == own) words.push_back({partition.base, partition.longwords});
  return words;
}

// Waits for writes to these words. Empty if there are none: only presence and heartbeats are
// carried then.
std::optional<broker::Waiter> waiter_for(broker::Ring& ring,
                                         const std::vector<broker::LongwordRange>& words) {
  if (words.empty()) return std::nullopt;
  return ring.wait_for(words, Duration{0});
}

/// @throws Error if writes were lost
Status wait_for_write(std::optional<broker::Waiter>& waiter, TimePoint deadline,
                      broker::Write& write) {
  if (!waiter) {
    WallClock{}.sleep_until(deadline);
    return Status::Late;
  }
  const Status status = waiter->wait(deadline, write);
  if (status == Status::LimitExceeded)
    throw Error{"writes were lost: it was more than a journal behind"};
  return status;
}

}  // namespace

/// A node of one ring, played on the other.
class Link::Double {
 public:
  Double(broker::Ring& ring, const std::string& name) : ring_{ring}, node_{ring.join(name, 0)} {}

  void write(const memmap::Map& map, LongwordOffset offset, bool is_group,
             std::span<const std::uint32_t> words) {
    const Status status =
        is_group ? node_.write_group(ring_.tear_group(map.partition_at(offset)->name), words)
                 : node_.write(offset, words[0]);
    if (status != Status::Ok)
      throw Error{fmt::format("the ring refused a write to longword {}", offset.value())};
  }
  /// The words that the node has on the other ring now: it wrote them before they were followed.
  void copy(const memmap::Map& map, const std::string& name, broker::Node& from,
            broker::Ring& ring) {
    for (const auto& partition : map.partitions()) {
      if (partition.node != name) continue;
      std::vector<std::uint32_t> words(partition.longwords);
      if (partition.tear_group) {
        if (from.read_group(ring.tear_group(partition.name), words) == Status::Ok)
          write(map, partition.base, true, words);
        continue;
      }
      for (std::uint32_t i = 0; i < partition.longwords; ++i) {
        const LongwordOffset offset{partition.base.value() + i};
        const std::uint32_t word = from.read(offset);
        if (word != node_.read(offset)) write(map, offset, false, {&word, 1});
      }
    }
  }
  void beat_with(std::uint64_t beats) {
    if (beats != beats_) node_.beat();
    beats_ = beats;
  }
  [[nodiscard]] std::uint32_t read(LongwordOffset offset) const { return node_.read(offset); }

 private:
  broker::Ring& ring_;
  broker::Node node_;
  std::uint64_t beats_ = 0;
};

/// Writes of the node to the ring of the laboratory.
class Link::Outward {
 public:
  explicit Outward(Link& link)
      : link_{link},
        from_{broker::Ring::attach(link.image_)},
        to_{broker::Ring::attach(link.ring_)},
        observer_{from_.observe()},
        watch_{from_},
        waiter_{waiter_for(from_, words_of(link.map_, link.node_, true))},
        id_{link.map_.node(link.node_)} {}

  void advance() {
    const TimePoint now = clock_.now();
    if (now >= next_look_) look(now);
    broker::Write write;
    TimePoint deadline = next_look_;
    if (!waiting_.empty()) deadline = std::min(deadline, waiting_.front().due);
    if (wait_for_write(waiter_, deadline, write) == Status::Ok) take(write);
    send();
  }

 private:
  void look(TimePoint now) {
    link_.foreign_log_.look(watch_);
    next_look_ = now + (watch_.is_plain(link_.node_) ? kPlainLook : kLinkLook);
    const auto state = observer_.presence_of(id_).state;
    if (state == State::Alive && !node_) node_.emplace(to_, link_.node_);
    // Its last writes are taken before the second look.
    absent_looks_ = state == State::Absent ? absent_looks_ + 1 : 0;
    if (absent_looks_ > 1 && waiting_.empty()) node_.reset();
    if (!node_) return;
    const std::lock_guard lock{link_.mutex_};
    if (!link_.faults_.drops_all) node_->beat_with(observer_.beats_of(id_));
  }
  void take(const broker::Write& write) {
    const std::lock_guard lock{link_.mutex_};
    const Faults& faults = link_.faults_;
    if (!node_) node_.emplace(to_, link_.node_);
    if (faults.drops_all) return;
    Message message{clock_.now() + faults.delay, write.offset.value(), !write.group.empty(), {}};
    if (message.is_group)
      message.words.assign(write.group.begin(), write.group.end());
    else
      message.words = {write.value};
    if (!message.is_group && faults.dropped.contains(message.offset)) return;
    for (std::uint32_t i = 0; i < message.words.size(); ++i) {
      const std::uint32_t offset = message.offset + i;
      if (faults.dropped.contains(offset)) message.words[i] = node_->read(LongwordOffset{offset});
      if (const auto flip = faults.flips.find(offset); flip != faults.flips.end())
        message.words[i] ^= flip->second;
    }
    waiting_.push_back(std::move(message));
  }
  // In the order of the writes, also after the delay changed.
  void send() {
    while (!waiting_.empty() && waiting_.front().due <= clock_.now()) {
      const Message& message = waiting_.front();
      node_->write(link_.map_, LongwordOffset{message.offset}, message.is_group, message.words);
      waiting_.pop_front();
    }
  }

  Link& link_;
  broker::Ring from_, to_;
  broker::Node observer_;
  broker::Watch watch_;
  std::optional<broker::Waiter> waiter_;
  NodeId id_;
  std::optional<Double> node_;  ///< on the ring of the laboratory
  std::deque<Message> waiting_;
  int absent_looks_ = 0;
  TimePoint next_look_{0};
  WallClock clock_;
};

/// Writes of the other nodes to the ring of the program.
class Link::Inward {
 public:
  explicit Inward(Link& link)
      : link_{link},
        from_{broker::Ring::attach(link.ring_)},
        to_{broker::Ring::attach(link.image_)},
        observer_{from_.observe()},
        waiter_{waiter_for(from_, words_of(link.map_, link.node_, false))},
        id_{link.map_.node(link.node_)} {
    look();
    for (auto& [name, node] : nodes_) node.copy(link.map_, name, observer_, from_);
  }

  void advance() {
    if (clock_.now() >= next_look_) look();
    broker::Write write;
    if (wait_for_write(waiter_, next_look_, write) != Status::Ok || write.writer == id_) return;
    const bool is_group = !write.group.empty();
    play(write.writer)
        .write(link_.map_, write.offset, is_group,
               is_group ? write.group : std::span{&write.value, 1});
  }

 private:
  Double& play(NodeId id) {
    const std::string name = link_.map_.node_name(id);
    if (const auto found = nodes_.find(name); found != nodes_.end()) return found->second;
    return nodes_.try_emplace(name, to_, name).first->second;
  }
  void look() {
    next_look_ = clock_.now() + kLinkLook;
    for (const auto& node : link_.map_.description().nodes) {
      if (node.name == link_.node_) continue;
      const auto state = observer_.presence_of(node.id).state;
      if (state == State::Alive) play(node.id).beat_with(observer_.beats_of(node.id));
      if (state == State::Absent) nodes_.erase(node.name);
    }
  }

  Link& link_;
  broker::Ring from_, to_;
  broker::Node observer_;
  std::optional<broker::Waiter> waiter_;
  NodeId id_;
  std::map<std::string, Double> nodes_;  ///< on the ring of the program
  TimePoint next_look_{0};
  WallClock clock_;
};

Link::Link(const std::string& ring, const memmap::Map& map, const std::string& node)
    : ring_{ring}, image_{ring + "." + node}, node_{node}, map_{map} {
  static_cast<void>(map.node(node));
  const auto image = broker::Ring::create(image_, map);
  threads_.emplace_back([this] { carry<Outward>(); });
  threads_.emplace_back([this] { carry<Inward>(); });
  WallClock clock;
  while (ready_.load() < 2) clock.sleep_until(clock.now() + std::chrono::milliseconds{1});
}

Link::~Link() {
  ends_.store(true);
  for (auto& thread : threads_) thread.join();
  broker::remove_ring(image_);
}

template <class Direction>
void Link::carry() {
  bool is_ready = false;
  try {
    Direction direction{*this};
    is_ready = true;
    ready_.fetch_add(1);
    while (!ends_.load(std::memory_order_relaxed)) direction.advance();
  } catch (const Error& error) {
    const std::lock_guard lock{mutex_};
    if (trouble_.empty()) trouble_ = fmt::format("the link of node '{}': {}", node_, error.what());
  }
  if (!is_ready) ready_.fetch_add(1);
}

std::string Link::trouble() const {
  const std::lock_guard lock{mutex_};
  return trouble_;
}

}  // namespace rths::testkit

// SPDX-License-Identifier: Apache-2.0
#include "outbox.hpp"

#include <algorithm>
#include <thread>

#include "clock_offset.hpp"
#include "hello.hpp"

namespace rths::dds {
namespace {

constexpr std::size_t kFullFrame = 8UL * 1024;        // [B]
constexpr std::size_t kSnapshotFrame = 56UL * 1024;   // [B]
constexpr std::size_t kHistory = 16UL * 1024 * 1024;  // sent bytes kept per stream
constexpr Duration kHelloPeriod = std::chrono::milliseconds{50};
constexpr Duration kDigestPeriod = std::chrono::seconds{1};
constexpr Duration kAfterLastWrite = std::chrono::milliseconds{300};
// A silent host is lost by then.
constexpr Duration kLongestAfterLastWrite = std::chrono::seconds{12};
constexpr Duration kRest = std::chrono::microseconds{50};
constexpr Duration kLongestIdle = std::chrono::milliseconds{2};
constexpr int kMostWrites = 4096;                           // between two looks at the clock
constexpr Duration kLongestHold = std::chrono::seconds{2};  // of an interrupt
constexpr Duration kLatestPeriod = std::chrono::milliseconds{1};

// On two processors, spinning would take one from the programs of the test.
Duration longest_spin() {
  return std::thread::hardware_concurrency() > 2 ? broker::kLongestSpin : Duration{0};
}

}  // namespace

Outbox::Outbox(const std::string& ring, Shared& shared)
    : shared_{shared},
      ring_{broker::Ring::attach(ring)},
      reader_{ring_.observe()},
      waiter_{ring_.wait_for({}, longest_spin())},
      by_id_(shared.is_remote.size()) {
  for (const auto& node : ring_.map().description().nodes) {
    Stream stream{node.id, NodeWords{ring_, node.name}};
    stream.vanished_before =
        reader_.presence_of(node.id).state == broker::Presence::State::Vanished;
    by_id_[node.id.value()] = &streams_.emplace(node.id.value(), std::move(stream)).first->second;
  }
}

void Outbox::run() {
  if (shared_.options.prepare_thread) shared_.options.prepare_thread();
  const WallClock clock;
  while (!shared_.ends.load(std::memory_order_relaxed)) {
    now_ = clock.now();
    do_periodic_work();
    answer();
    take_interrupts();
    int writes = 0;
    while (writes < kMostWrites && take_write(TimePoint{0})) ++writes;
    if (writes == kMostWrites) continue;
    append_interrupts();
    flush_all();
    send_digest();
    static_cast<void>(take_write(std::min(hello_, now_ + kLongestIdle)));
  }
  flush_all();
  send_hello(true);
}

void Outbox::do_periodic_work() {
  if (now_ >= hello_) {
    find_local_nodes();
    flush_all();  // an announcement follows the updates that it counts
    send_hello();
    hello_ = now_ + kHelloPeriod;
  }
  if (now_ >= digest_) {
    for (const auto& [id, stream] : streams_)
      if (stream.announced) undigested_.insert(id);
    digest_ = now_ + kDigestPeriod;
  }
  if (now_ >= latest_) {
    append_latest();
    latest_ = now_ + kLatestPeriod;
  }
}

bool Outbox::take_write(TimePoint deadline) {
  broker::Write write{};
  const Status status = waiter_.wait(deadline, write);
  if (status == Status::LimitExceeded) resume_after_loss();
  if (status != Status::Ok) return status == Status::LimitExceeded;
  Stream* const stream = stream_of(write.writer);
  if (stream == nullptr) return true;
  if (is_remote(write.writer))
    waiter_.ignore(write.writer, true);
  else
    take(*stream, write);
  return true;
}

void Outbox::take(Stream& stream, const broker::Write& write) {
  if (!stream.announced) hello_ = TimePoint{0};
  stream.written = now_;
  append_card_changes(stream);
  if (shared_.options.skips_unchanged && leaves_all_as_sent(write)) return;
  if (!shared_.options.is_deterministic && stream.words.is_latest(write.offset))
    stream.changed.insert(write.offset);
  else
    append(stream, write);
}

bool Outbox::leaves_all_as_sent(const broker::Write& write) {
  const std::span words = write.group.empty() ? std::span{&write.value, 1} : write.group;
  bool all = true;
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    const auto [sent, is_new] = sent_.try_emplace(advance(write.offset, i), words[i]);
    all = all && !is_new && sent->second == words[i];
    sent->second = words[i];
  }
  return all;
}

void Outbox::append_latest() {
  std::vector<std::uint32_t> values;
  for (auto& [id, stream] : streams_) {
    for (auto word = stream.changed.begin(); word != stream.changed.end();) {
      broker::Write write{stream.node, *word, 0, {}};
      const auto* const group = stream.words.group_from(*word);
      if (group == nullptr) {
        write.value = reader_.read(*word);
      } else {
        values.resize(group->longwords);
        if (reader_.read_group(group->id, values) != Status::Ok) {
          ++word;  // being written: next time
          continue;
        }
        write.group = values;
      }
      append(stream, write);
      word = stream.changed.erase(word);
    }
  }
}

// A journal has lost writes, it is not known of which node.
void Outbox::resume_after_loss() {
  ++shared_.counts.lapped;
  flush_all();
  sent_.clear();
  for (auto& [id, stream] : streams_) {
    if (!stream.announced) continue;
    stream.sent.clear();
    stream.sent_bytes = 0;
    ++stream.next;
    send_snapshot(stream, 0);
  }
}

Outbox::Stream* Outbox::stream_of(NodeId node) const {
  return node.value() < by_id_.size() ? by_id_[node.value()] : nullptr;
}

bool Outbox::is_remote(NodeId node) const {
  return shared_.is_remote[node.value()].load(std::memory_order_acquire);
}

FrameHeader Outbox::header(FrameKind kind, const Stream& stream) const {
  FrameHeader header;
  header.kind = kind;
  header.host = shared_.host;
  header.map_hash = shared_.map_hash;
  header.node = stream.node.value();
  header.first = stream.next;
  header.sent = WallClock{}.now().count();
  return header;
}

FrameWriter& Outbox::room_in(Stream& stream, std::size_t words) {
  const std::size_t bytes = FrameWriter::size_of(words);
  if (stream.pending && stream.pending->bytes() + bytes > kFullFrame) flush(stream);
  if (!stream.pending) stream.pending.emplace(header(FrameKind::Updates, stream));
  return *stream.pending;
}

void Outbox::append(Stream& stream, const broker::Write& write) {
  FrameWriter& frame = room_in(stream, write.group.size());
  if (write.group.empty())
    frame.add_word(write.offset, write.value);
  else
    frame.add_group(write.offset, write.group);
  ++stream.next;
}

void Outbox::append(Stream& stream, std::span<const std::uint32_t> card_message) {
  room_in(stream, card_message.size()).add_card_message(card_message);
  ++stream.next;
}

// A program sets the registers of its card before it stores, so changes precede the next write.
void Outbox::append_card_changes(Stream& stream) {
  if (shared_.cards->none()) return;
  for (const auto& message : shared_.cards->changes_of(stream.node)) append(stream, message);
}

void Outbox::take_interrupts() {
  if (shared_.cards->none()) return;
  for (auto& [id, stream] : streams_)
    if (stream.announced) append_card_changes(stream);
  std::vector<Cards::Interrupt> taken;
  shared_.counts.interrupts_lost += shared_.cards->take_interrupts(now_, taken);
  for (auto& interrupt : taken) interrupts_.push_back({std::move(interrupt), now_});
}

// A host that has just learned of a node gets a snapshot first, which has no interrupts.
Outbox::Readiness Outbox::readiness_of(const WaitingInterrupt& waiting) const {
  const auto& [interrupt, since] = waiting;
  const Stream* const stream = interrupt.from ? stream_of(*interrupt.from) : nullptr;
  if (stream == nullptr || is_remote(stream->node)) return Readiness::Lost;
  const std::lock_guard lock{shared_.mutex};
  const auto owner = shared_.owners.find(interrupt.to.value());
  if (stream->announced && owner != shared_.owners.end() &&
      has(owner->second, *stream, stream->joined))
    return Readiness::Ready;
  return now_ - since > kLongestHold ? Readiness::Lost : Readiness::Waits;
}

bool Outbox::has(HostId host, const Stream& stream, std::uint64_t number) const {
  const auto confirmed = shared_.confirmed.find(host);
  if (confirmed == shared_.confirmed.end()) return false;
  const auto found = confirmed->second.find(stream.node.value());
  return found != confirmed->second.end() && found->second >= number;
}

// Interrupts of one card for another one keep their order.
void Outbox::append_interrupts() {
  if (interrupts_.empty()) return;
  std::vector<WaitingInterrupt> waiting;
  std::set<std::pair<std::uint16_t, std::uint16_t>> behind;
  for (auto& one : interrupts_) {
    const auto readiness = readiness_of(one);
    if (readiness == Readiness::Lost) {
      count_lost_interrupt(one.interrupt);
      continue;
    }
    Stream& stream = *stream_of(*one.interrupt.from);
    const std::pair way{stream.node.value(), one.interrupt.to.value()};
    if (readiness == Readiness::Waits || behind.contains(way)) {
      behind.insert(way);
      waiting.push_back(std::move(one));
    } else {
      append(stream, one.interrupt.message);
      ++shared_.counts.interrupts_sent;
    }
  }
  interrupts_ = std::move(waiting);
}

void Outbox::count_lost_interrupt(const Cards::Interrupt& interrupt) {
  ++shared_.counts.interrupts_lost;
  const bool is_of_a_node = interrupt.from && stream_of(*interrupt.from) != nullptr;
  if (is_of_a_node || std::exchange(has_foreign_interrupt_, true)) return;
  shared_.report(
      "an interrupt was not sent to other hosts: its card is no node of the map; name one in "
      "RTHS_SCGT_NODE");
}

void Outbox::flush(Stream& stream) {
  if (!stream.pending) return;
  SentFrame frame;
  frame.count = stream.pending->count();
  frame.first = stream.next - frame.count;
  frame.bytes = stream.pending->finish();
  stream.pending.reset();
  send(frame.bytes);
  shared_.counts.updates_sent += frame.count;
  stream.sent_bytes += frame.bytes.size();
  stream.sent.push_back(std::move(frame));
  while (stream.sent_bytes > kHistory) {
    stream.sent_bytes -= stream.sent.front().bytes.size();
    stream.sent.pop_front();
  }
}

void Outbox::flush_all() {
  for (auto& [id, stream] : streams_) flush(stream);
}

void Outbox::send(std::span<const std::byte> bytes) {
  const WallClock clock;
  const TimePoint begun = clock.now();
  if (shared_.carrier->send(bytes)) ++shared_.counts.frames_sent;
  constexpr Duration kUnblocked = std::chrono::microseconds{200};
  const Duration took = clock.now() - begun;
  if (took > kUnblocked) shared_.counts.hold_off_ns += static_cast<std::uint64_t>(took.count());
}

// A node belongs to this host from its first write or announcement here until it leaves. A program
// that only writes a word and ends is announced until the other hosts have the word. Nodes that had
// vanished before this gateway started may be those of other hosts, joined by a killed gateway.
bool Outbox::is_here(Stream& stream) const {
  using State = broker::Presence::State;
  if (is_remote(stream.node)) return false;
  const State state = reader_.presence_of(stream.node).state;
  if (state != State::Vanished) stream.vanished_before = false;
  if (state != State::Absent && !stream.vanished_before) return true;
  const bool has_interrupts =
      std::any_of(interrupts_.begin(), interrupts_.end(),
                  [&](const auto& waiting) { return waiting.interrupt.from == stream.node; });
  return has_interrupts || (stream.written != TimePoint{0} && !is_known_elsewhere(stream));
}

bool Outbox::is_known_elsewhere(const Stream& stream) const {
  const std::lock_guard lock{shared_.mutex};
  const TimePoint since = std::max(stream.written, shared_.newest_host);
  if (shared_.confirmed.empty() || now_ - since < kAfterLastWrite) return false;
  if (now_ - since > kLongestAfterLastWrite) return true;
  return !stream.pending && stream.changed.empty() &&
         std::all_of(shared_.confirmed.begin(), shared_.confirmed.end(),
                     [&](const auto& host) { return has(host.first, stream, stream.next); });
}

void Outbox::find_local_nodes() {
  for (auto& [id, stream] : streams_) {
    const bool announced = is_here(stream);
    waiter_.ignore(stream.node, is_remote(stream.node));
    if (!announced) flush(stream);
    if (announced && !stream.announced) {
      for (const auto& message : shared_.cards->state_of(stream.node)) append(stream, message);
      stream.joined = stream.next;
    }
    stream.announced = announced;
  }
}

void Outbox::send_hello(bool is_last) {
  Hello hello;
  hello.is_last = is_last;
  hello.host = shared_.options.host;
  hello.real_time = real_time_offset();
  {
    const std::lock_guard lock{shared_.mutex};
    hello.echoes = shared_.echoes;
    hello.received = shared_.received;
    hello.missed = shared_.missed;
  }
  for (const auto& [id, stream] : streams_)
    if (stream.announced) hello.nodes.push_back({id, stream.next, reader_.beats_of(stream.node)});
  FrameHeader header;
  header.kind = FrameKind::Hello;
  header.host = shared_.host;
  header.map_hash = shared_.map_hash;
  header.sent = WallClock{}.now().count();
  FrameWriter frame{header};
  frame.add_bytes(to_bytes(hello));
  send(frame.finish());
}

// A write during the hash would make the digests differ, so the node's words have to rest a while.
void Outbox::send_digest() {
  if (undigested_.empty()) return;
  const Stream& stream = streams_.at(*undigested_.begin());
  if (!stream.changed.empty()) return;
  const auto hash = stream.words.hash(reader_);
  if (take_write(WallClock{}.now() + kRest)) return;
  undigested_.erase(undigested_.begin());
  if (!hash) return;
  FrameWriter frame{header(FrameKind::Digest, stream)};
  frame.add_bytes(bytes_of(*hash));
  send(frame.finish());
}

void Outbox::answer() {
  std::vector<Asked> asked;
  std::vector<std::vector<std::byte>> to_send;
  {
    const std::lock_guard lock{shared_.mutex};
    asked.swap(shared_.asked);
    to_send.swap(shared_.to_send);
  }
  for (const auto& bytes : to_send) send(bytes);
  for (const auto& one : asked)
    if (Stream* const stream = stream_of(NodeId{one.node}); stream && !is_remote(stream->node))
      answer(*stream, one);
}

void Outbox::answer(Stream& stream, const Asked& asked) {
  flush(stream);
  const bool has_them = asked.end != 0 && !stream.sent.empty() &&
                        stream.sent.front().first <= asked.first && asked.first < stream.next;
  if (!has_them) return send_snapshot(stream, asked.by);
  for (const auto& frame : stream.sent) {
    if (frame.first + frame.count <= asked.first || frame.first >= asked.end) continue;
    send(frame.bytes);
    ++shared_.counts.sent_again;
  }
}

// The words are read after the number of the next update, so they are as new as that update or
// newer; the updates that follow repeat the newest values.
void Outbox::send_snapshot(Stream& stream, HostId to) {
  flush(stream);
  std::optional<FrameWriter> frame;
  std::uint32_t index = 0;
  const auto send_part = [&](bool is_last) {
    // The part stands behind the updates, where it disturbs no reader of them.
    frame->add_bytes(bytes_of(SnapshotPart{to, index, is_last ? index + 1 : 0}));
    send(frame->finish());
    frame.reset();
    ++index;
  };
  const auto room_for = [&](std::size_t words) -> FrameWriter& {
    if (frame && frame->bytes() + FrameWriter::size_of(words) > kSnapshotFrame) send_part(false);
    if (!frame) frame.emplace(header(FrameKind::Snapshot, stream));
    return *frame;
  };
  // The card comes first, as the words that follow may interrupt.
  for (const auto& message : shared_.cards->state_of(stream.node))
    room_for(message.size()).add_card_message(message);
  stream.words.visit(
      reader_,
      [&](LongwordOffset offset, std::span<const std::uint32_t> values) {
        room_for(values.size()).add_run(offset, values);
      },
      [&](const NodeWords::Group& group, std::span<const std::uint32_t> values) {
        room_for(values.size()).add_group(group.base, values);
      });
  static_cast<void>(room_for(0));
  send_part(true);
}

}  // namespace rths::dds

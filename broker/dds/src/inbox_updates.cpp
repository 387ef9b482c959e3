// SPDX-License-Identifier: Apache-2.0
//
// Updates, snapshots and digests of a stream, and requests for them.
#include "inbox.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::dds {
namespace {

constexpr Duration kAskAgain = std::chrono::milliseconds{30};
constexpr std::size_t kMostWaiting = 4096;  // frames behind a gap

}  // namespace

void Inbox::receive_updates(Stream& stream, const Frame& frame, std::span<const std::byte> bytes) {
  const auto& header = frame.header;
  if (stream.synced && header.first + header.count <= stream.expected) {
    shared_.counts.repeated += header.count;
    return;
  }
  if (!stream.synced || header.first > stream.expected) {
    if (stream.waiting.size() < kMostWaiting)
      stream.waiting.emplace(header.first, std::vector<std::byte>{bytes.begin(), bytes.end()});
    return;
  }
  apply(stream, frame);
  apply_waiting(stream);
}

void Inbox::apply_waiting(Stream& stream) {
  while (!stream.waiting.empty() && stream.waiting.begin()->first <= stream.expected) {
    const auto bytes = std::move(stream.waiting.begin()->second);
    stream.waiting.erase(stream.waiting.begin());
    FrameDefect defect{};
    if (const auto frame = decode(bytes, defect)) apply(stream, *frame);
  }
}

void Inbox::apply(Stream& stream, const Frame& frame) {
  UpdateReader reader{frame.payload};
  Update update;
  std::uint64_t number = frame.header.first;
  for (; reader.next(update) && number < frame.header.first + frame.header.count; ++number) {
    if (number < stream.expected) {
      ++shared_.counts.repeated;
      continue;
    }
    if (!write(stream, update))
      return bad_frame("a frame was dropped: it has words of other nodes");
    stream.expected = number + 1;
    ++shared_.counts.updates_received;
  }
  if (reader.malformed() || number != frame.header.first + frame.header.count)
    return bad_frame("a frame was dropped: malformed updates");
  note_time(stream, TimePoint{frame.header.sent});
}

bool Inbox::write(Stream& stream, const Update& update) {
  if (update.form == Update::Form::Card) return apply_card_message(stream, update.words);
  if (update.offset.value() >= ring_.map().description().size_longwords) return false;
  if (update.form == Update::Form::Run) return write_run(stream, update);
  if (update.form == Update::Form::Word)
    return stream.node.write(update.offset, update.value) == Status::Ok ||
           write_into_group(stream, update);
  const auto* const group = stream.words.group_at(update.offset, update.words.size());
  return group != nullptr && stream.node.write_group(group->id, update.words) == Status::Ok;
}

bool Inbox::apply_card_message(Stream& stream, std::span<const std::uint32_t> message) {
  try {
    return shared_.cards->apply(stream.id, message);
  } catch (const Error& error) {
    const auto reason = fmt::format("the card of node '{}' has no copy here: {}",
                                    ring_.map().node_name(stream.id), error.what());
    if (reported_.insert(reason).second) shared_.report(reason);
    return true;
  }
}

// A program written for the cards stores the words of a tear group one by one.
bool Inbox::write_into_group(Stream& stream, const Update& update) {
  const auto* const group = stream.words.group_with(update.offset);
  if (group == nullptr) return false;
  std::vector<std::uint32_t> words(group->longwords);
  if (stream.node.read_group(group->id, words) != Status::Ok) return false;
  words[update.offset.value() - group->base.value()] = update.value;
  return stream.node.write_group(group->id, words) == Status::Ok;
}

bool Inbox::write_run(Stream& stream, const Update& run) {
  const std::uint32_t size = ring_.map().description().size_longwords;
  if (run.words.size() > size - run.offset.value()) return false;
  Status status = Status::Ok;
  for (std::uint32_t i = 0; i < run.words.size() && status == Status::Ok; ++i)
    if (const auto word = advance(run.offset, i); stream.node.read(word) != run.words[i])
      status = stream.node.write(word, run.words[i]);
  return status == Status::Ok;
}

void Inbox::receive_snapshot(Stream& stream, const Frame& frame) {
  const std::size_t size = frame.payload.size();
  if (size < sizeof(SnapshotPart)) return bad_frame("a frame was dropped: malformed snapshot");
  auto tail = frame.payload.subspan(size - sizeof(SnapshotPart));
  const SnapshotPart part = *take<SnapshotPart>(tail);
  if (part.to != shared_.host && part.to != 0) return;
  if (stream.synced && frame.header.first < stream.expected) return;  // older than the ring
  if (frame.header.first != stream.part_first || stream.synced) {
    stream.parts.clear();
    stream.part_count = 0;
  }
  stream.part_first = frame.header.first;
  stream.synced = false;
  UpdateReader reader{frame.payload.first(size - sizeof(SnapshotPart))};
  for (Update update; reader.next(update);)
    if (!write(stream, update))
      return bad_frame("a frame was dropped: it has words of other nodes");
  if (reader.malformed()) return bad_frame("a frame was dropped: malformed snapshot");
  stream.parts.insert(part.index);
  stream.asked = now_;  // the rest is on its way
  if (part.parts != 0) stream.part_count = part.parts;
  if (stream.part_count == 0 || stream.parts.size() < stream.part_count) return;
  stream.parts.clear();
  stream.synced = true;
  stream.expected = frame.header.first;
  ++shared_.counts.snapshots;
  apply_waiting(stream);
}

void Inbox::receive_digest(Stream& stream, const Frame& frame) {
  auto payload = frame.payload;
  const auto hash = take<std::uint64_t>(payload);
  if (!hash || !stream.synced || frame.header.first != stream.expected) return;
  const auto ours = stream.words.hash(stream.node);
  if (!ours) return;
  // A sender that was stopped in the middle of a write makes one digest differ, not two in a row.
  stream.differing = *ours == *hash ? 0 : stream.differing + 1;
  if (stream.differing < 2) return;
  stream.differing = 0;
  ++shared_.counts.mismatches;
  stream.asked = TimePoint{0};
  ask(frame.header.node, stream, 0);
}

void Inbox::receive_request(const Frame& frame) {
  auto payload = frame.payload;
  const auto request = take<Request>(payload);
  if (!request || request->host != shared_.host) return;
  const std::lock_guard lock{shared_.mutex};
  const bool is_there = std::any_of(shared_.asked.begin(), shared_.asked.end(), [&](const auto& a) {
    return a.by == frame.header.host && a.node == frame.header.node && a.end == request->end;
  });
  if (!is_there)
    shared_.asked.push_back(
        {frame.header.host, frame.header.node, frame.header.first, request->end});
}

// end 0, or a stream without a snapshot: asks for a snapshot.
void Inbox::ask(std::uint16_t node, Stream& stream, std::uint64_t end) {
  if (stream.asked.count() != 0 && now_ - stream.asked < kAskAgain) return;
  stream.asked = now_;
  const bool for_snapshot = !stream.synced || end == 0;
  if (!for_snapshot) shared_.counts.gaps += end - stream.expected;
  FrameHeader header;
  header.kind = FrameKind::Request;
  header.host = shared_.host;
  header.map_hash = shared_.map_hash;
  header.node = node;
  header.first = for_snapshot ? 0 : stream.expected;
  FrameWriter frame{header};
  frame.add_bytes(bytes_of(Request{stream.host, for_snapshot ? 0 : end}));
  const std::lock_guard lock{shared_.mutex};
  shared_.to_send.push_back(frame.finish());
}

}  // namespace rths::dds

// SPDX-License-Identifier: Apache-2.0
//
// The bytes that gateways exchange. Little-endian; every frame is one DDS sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <rths/core/ids.hpp>

namespace rths::dds {

inline constexpr std::uint16_t kFrameVersion = 3;
/// Largest frame [B]: below the 64 KiB of a UDP datagram.
inline constexpr std::size_t kLargestFrame = 60'000;

/// Identifies one start of one gateway, so a restart is a new host with new streams.
using HostId = std::uint64_t;

enum class FrameKind : std::uint8_t {
  Hello = 1,  ///< the sender's name and its local nodes
  Updates,    ///< writes of one node, in order
  Snapshot,   ///< present words of one node
  Request,    ///< asks a host for updates again, or for a snapshot
  Digest,     ///< hash of one node's words at a position of its stream
};

/// Header of a frame. A stream is the writes of one node of one host, numbered from 0.
struct FrameHeader {
  FrameKind kind = FrameKind::Hello;
  HostId host = 0;  ///< sender
  std::uint64_t map_hash = 0;
  std::uint16_t node = 0;   ///< NodeId of the stream
  std::uint16_t count = 0;  ///< of updates in the payload
  std::uint64_t first = 0;  ///< number of the first update; of a snapshot or digest: the next one
  std::int64_t sent = 0;    ///< CLOCK_MONOTONIC of the sender [ns]
};

/// Why bytes are no frame.
enum class FrameDefect : std::uint8_t { Length, Magic, Version, Kind, Time, Checksum };
[[nodiscard]] const char* to_text(FrameDefect defect) noexcept;

/// A received frame; its payload refers to the received bytes.
struct Frame {
  FrameHeader header;
  std::span<const std::byte> payload;
};

/// Reads a frame from bytes that anyone may have sent. Checks length, version and checksum.
/// @param defect  set if there is none
[[nodiscard]] std::optional<Frame> decode(std::span<const std::byte> bytes, FrameDefect& defect);

/// One element of a stream: a write of a word, or of a tear group. In a snapshot also a run of
/// words. Or a message of the node's card.
struct Update {
  enum class Form : std::uint8_t { Word, Group, Run, Card };
  Form form = Form::Word;
  LongwordOffset offset;             ///< not of a message
  std::uint32_t value = 0;           ///< of a word
  std::vector<std::uint32_t> words;  ///< of the others
};

/// Reads the updates of a payload one by one.
class UpdateReader {
 public:
  explicit UpdateReader(std::span<const std::byte> payload) : rest_{payload} {}
  /// @returns false at the end or at a malformed update, which `malformed` tells apart
  [[nodiscard]] bool next(Update& update);
  [[nodiscard]] bool malformed() const { return malformed_; }

 private:
  std::span<const std::byte> rest_;
  bool malformed_ = false;
};

/// Collects updates of one stream and makes frames of them.
class FrameWriter {
 public:
  /// Begins a frame.
  explicit FrameWriter(const FrameHeader& header);
  /// Size of an update in a frame [B]; words of the group, run or message, or 0 for a word.
  [[nodiscard]] static std::size_t size_of(std::size_t words) { return 8 + 4 * words; }
  void add_word(LongwordOffset offset, std::uint32_t value);
  void add_group(LongwordOffset offset, std::span<const std::uint32_t> words);
  void add_run(LongwordOffset offset, std::span<const std::uint32_t> words);
  void add_card_message(std::span<const std::uint32_t> words);
  void add_bytes(std::span<const std::byte> bytes);
  [[nodiscard]] std::size_t bytes() const { return bytes_.size(); }
  [[nodiscard]] std::uint16_t count() const { return header_.count; }
  /// The frame, with its checksum.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  void add(std::uint32_t first, std::uint32_t second);
  void add_words(Update::Form form, LongwordOffset offset, std::span<const std::uint32_t> words);
  FrameHeader header_;
  std::vector<std::byte> bytes_;
};

}  // namespace rths::dds

// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <array>
#include <bit>
#include <cstring>

#include <xxhash.h>

namespace rths::dds {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

constexpr std::uint32_t kMagic = 0x46485452;                  // "RTHF"
constexpr std::uint32_t kForm = 0xC0000000, kFormShift = 30;  // in the first word of an update
constexpr std::size_t kUsualFrame = 8UL * 1024;               // [B]
constexpr std::int64_t kLatestTime = std::int64_t{1} << 60;   // [ns], 36 years after the start

/// The header as it is in a frame.
struct WireHeader {
  std::uint32_t magic;
  std::uint16_t version;
  std::uint8_t kind, reserved;
  std::uint64_t host, map_hash;
  std::uint16_t node, count;
  std::uint32_t payload_bytes;
  std::uint64_t first;
  std::int64_t sent;
  std::uint64_t checksum;  ///< of all bytes, with 0 here
};
static_assert(sizeof(WireHeader) == 56 && std::is_trivially_copyable_v<WireHeader>);

std::uint64_t checksum_of(WireHeader wire, std::span<const std::byte> payload) {
  wire.checksum = 0;
  return XXH3_64bits_withSeed(payload.data(), payload.size(), XXH3_64bits(&wire, sizeof wire));
}

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t index) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + 4 * index, sizeof word);
  return word;
}

}  // namespace

const char* to_text(FrameDefect defect) noexcept {
  constexpr const char* kTexts[] = {
      "wrong length",          "no frame of a gateway", "another version of frames",
      "unknown kind of frame", "impossible time",       "wrong checksum"};
  return kTexts[static_cast<std::size_t>(defect)];
}

std::optional<Frame> decode(std::span<const std::byte> bytes, FrameDefect& defect) {
  const auto refuse = [&](FrameDefect found) {
    defect = found;
    return std::nullopt;
  };
  WireHeader wire;
  if (bytes.size() < sizeof wire || bytes.size() > kLargestFrame)
    return refuse(FrameDefect::Length);
  std::memcpy(&wire, bytes.data(), sizeof wire);
  if (wire.magic != kMagic) return refuse(FrameDefect::Magic);
  if (wire.version != kFrameVersion) return refuse(FrameDefect::Version);
  const auto payload = bytes.subspan(sizeof wire);
  if (payload.size() != wire.payload_bytes) return refuse(FrameDefect::Length);
  if (wire.checksum != checksum_of(wire, payload)) return refuse(FrameDefect::Checksum);
  if (wire.kind < static_cast<std::uint8_t>(FrameKind::Hello) ||
      wire.kind > static_cast<std::uint8_t>(FrameKind::Digest))
    return refuse(FrameDefect::Kind);
  if (wire.sent < 0 || wire.sent > kLatestTime) return refuse(FrameDefect::Time);
  return Frame{{static_cast<FrameKind>(wire.kind), wire.host, wire.map_hash, wire.node, wire.count,
                wire.first, wire.sent},
               payload};
}

bool UpdateReader::next(Update& update) {
  if (rest_.empty()) return false;
  const std::size_t words = rest_.size() / 4;
  malformed_ = rest_.size() % 4 != 0 || words < 2;
  if (malformed_) return false;
  const std::uint32_t head = word_at(rest_, 0), second = word_at(rest_, 1);
  update.offset = LongwordOffset{head & ~kForm};
  update.form = static_cast<Update::Form>(head >> kFormShift);
  update.words.clear();
  if (update.form == Update::Form::Word) {
    update.value = second;
    rest_ = rest_.subspan(8);
    return true;
  }
  malformed_ = second == 0 || second > words - 2;
  if (malformed_) return false;
  update.words.resize(second);
  std::memcpy(update.words.data(), rest_.data() + 8, 4UL * second);
  rest_ = rest_.subspan(8 + 4UL * second);
  return true;
}

FrameWriter::FrameWriter(const FrameHeader& header) : header_{header} {
  bytes_.reserve(kUsualFrame);
  bytes_.resize(sizeof(WireHeader));
  header_.count = 0;
}

void FrameWriter::add(std::uint32_t first, std::uint32_t second) {
  const std::array<std::uint32_t, 2> words{first, second};
  add_bytes(std::as_bytes(std::span{words}));
}

void FrameWriter::add_word(LongwordOffset offset, std::uint32_t value) {
  add(offset.value(), value);
  ++header_.count;
}

void FrameWriter::add_words(Update::Form form, LongwordOffset offset,
                            std::span<const std::uint32_t> words) {
  add(offset.value() | static_cast<std::uint32_t>(form) << kFormShift,
      static_cast<std::uint32_t>(words.size()));
  add_bytes(std::as_bytes(words));
  ++header_.count;
}

void FrameWriter::add_group(LongwordOffset offset, std::span<const std::uint32_t> words) {
  add_words(Update::Form::Group, offset, words);
}

void FrameWriter::add_run(LongwordOffset offset, std::span<const std::uint32_t> words) {
  add_words(Update::Form::Run, offset, words);
}

void FrameWriter::add_card_message(std::span<const std::uint32_t> words) {
  add_words(Update::Form::Card, LongwordOffset{0}, words);
}

void FrameWriter::add_bytes(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::vector<std::byte> FrameWriter::finish() {
  const auto payload = std::span<const std::byte>{bytes_}.subspan(sizeof(WireHeader));
  WireHeader wire{kMagic,
                  kFrameVersion,
                  static_cast<std::uint8_t>(header_.kind),
                  0,
                  header_.host,
                  header_.map_hash,
                  header_.node,
                  header_.count,
                  static_cast<std::uint32_t>(payload.size()),
                  header_.first,
                  header_.sent,
                  0};
  wire.checksum = checksum_of(wire, payload);
  std::memcpy(bytes_.data(), &wire, sizeof wire);
  bytes_.shrink_to_fit();  // many small frames are kept
  return std::move(bytes_);
}

}  // namespace rths::dds

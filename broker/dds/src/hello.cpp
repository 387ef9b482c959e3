// SPDX-License-Identifier: Apache-2.0
#include "hello.hpp"

#include <algorithm>
#include <cstring>

namespace rths::dds {
namespace {

constexpr std::size_t kLongestName = 63;
constexpr std::size_t kMostNodes = 1024, kMostHosts = 1024;
constexpr std::int64_t kLatestRealTime = std::int64_t{1} << 62;  // [ns], the year 2116

/// The numbers of a Hello as they are in a frame, before its lists.
struct WireHello {
  std::int64_t real_time;
  std::uint64_t nodes, received, echoes, missed, is_last;
};
struct WireNode {
  std::uint64_t node, next, beats;
};
struct WireReceived {
  std::uint64_t host, node, expected;
};
struct WireEcho {
  std::uint64_t host;
  std::int64_t sent, received;
};

void append(std::vector<std::byte>& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

}  // namespace

template <class Plain>
std::optional<Plain> take(std::span<const std::byte>& bytes) {
  Plain plain;
  if (bytes.size() < sizeof plain) return std::nullopt;
  std::memcpy(&plain, bytes.data(), sizeof plain);
  bytes = bytes.subspan(sizeof plain);
  return plain;
}
template std::optional<Request> take(std::span<const std::byte>&);
template std::optional<SnapshotPart> take(std::span<const std::byte>&);
template std::optional<std::uint64_t> take(std::span<const std::byte>&);

namespace {

void append_name(std::vector<std::byte>& to, const std::string& name) {
  const std::uint32_t length = static_cast<std::uint32_t>(std::min(name.size(), kLongestName));
  append(to, bytes_of(length));
  append(to, std::as_bytes(std::span{name.data(), length}));
}

std::optional<std::string> take_name(std::span<const std::byte>& bytes) {
  const auto length = take<std::uint32_t>(bytes);
  if (!length || *length > kLongestName || *length > bytes.size()) return std::nullopt;
  std::string name{reinterpret_cast<const char*>(bytes.data()), *length};
  bytes = bytes.subspan(*length);
  return printable(std::move(name));
}

}  // namespace

std::string printable(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return name;
}

std::vector<std::byte> to_bytes(const Hello& hello) {
  std::vector<std::byte> bytes;
  append_name(bytes, hello.host);
  append(bytes,
         bytes_of(WireHello{hello.real_time.count(), hello.nodes.size(), hello.received.size(),
                            hello.echoes.size(), hello.missed.size(), hello.is_last ? 1U : 0U}));
  for (const auto& node : hello.nodes)
    append(bytes, bytes_of(WireNode{node.node, node.next, node.beats}));
  for (const auto& stream : hello.received)
    append(bytes, bytes_of(WireReceived{stream.host, stream.node, stream.expected}));
  for (const auto& echo : hello.echoes)
    append(bytes, bytes_of(WireEcho{echo.host, echo.sent.count(), echo.received.count()}));
  for (const auto& missed : hello.missed) {
    append(bytes, bytes_of(std::int64_t{missed.silence.count()}));
    append_name(bytes, missed.host);
  }
  return bytes;
}

namespace {

// Reads a number of plain values and hands each to `add`. @returns false if there are fewer
template <class Plain, class Add>
bool take_each(std::span<const std::byte>& bytes, std::uint64_t count, Add add) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto plain = take<Plain>(bytes);
    if (!plain) return false;
    add(*plain);
  }
  return true;
}

}  // namespace

std::optional<Hello> hello_from(std::span<const std::byte> bytes) {
  auto host = take_name(bytes);
  const auto numbers = take<WireHello>(bytes);
  if (!host || !numbers || numbers->nodes > kMostNodes || numbers->received > kMostNodes ||
      numbers->echoes > kMostHosts || numbers->missed > kMostHosts)
    return std::nullopt;
  if (numbers->real_time < 0 || numbers->real_time > kLatestRealTime) return std::nullopt;
  Hello hello;
  hello.host = std::move(*host);
  hello.real_time = Duration{numbers->real_time};
  hello.is_last = numbers->is_last != 0;
  const bool complete =
      take_each<WireNode>(
          bytes, numbers->nodes,
          [&](const WireNode& node) {
            hello.nodes.push_back({static_cast<std::uint16_t>(node.node), node.next, node.beats});
          }) &&
      take_each<WireReceived>(
          bytes, numbers->received,
          [&](const WireReceived& stream) {
            hello.received.push_back(
                {stream.host, static_cast<std::uint16_t>(stream.node), stream.expected});
          }) &&
      take_each<WireEcho>(bytes, numbers->echoes, [&](const WireEcho& echo) {
        hello.echoes.push_back({echo.host, TimePoint{echo.sent}, TimePoint{echo.received}});
      });
  if (!complete) return std::nullopt;
  for (std::uint64_t i = 0; i < numbers->missed; ++i) {
    const auto silence = take<std::int64_t>(bytes);
    auto name = take_name(bytes);
    if (!silence || !name) return std::nullopt;
    hello.missed.push_back({std::move(*name), Duration{*silence}});
  }
  if (!bytes.empty()) return std::nullopt;
  return hello;
}

}  // namespace rths::dds

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
  std::uint64_t nodes, received;
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
template std::optional<Part> take(std::span<const std::byte>&);
template std::optional<std::uint64_t> take(std::span<const std::byte>&);

std::vector<std::byte> to_bytes(const Hello& hello) {
  const std::uint32_t length =
      static_cast<std::uint32_t>(std::min(hello.host.size(), kLongestName));
  std::vector<std::byte> bytes;
  append(bytes, bytes_of(length));
  append(bytes, std::as_bytes(std::span{hello.host.data(), length}));
  append(bytes,
         bytes_of(WireHello{hello.real_time.count(), hello.nodes.size(), hello.received.size()}));
  for (const auto& node : hello.nodes)
    append(bytes, bytes_of(WireNode{node.node, node.next, node.beats}));
  for (const auto& stream : hello.received)
    append(bytes, bytes_of(WireReceived{stream.host, stream.node, stream.expected}));
  for (const auto& echo : hello.echoes)
    append(bytes, bytes_of(WireEcho{echo.host, echo.sent.count(), echo.received.count()}));
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
  const auto length = take<std::uint32_t>(bytes);
  if (!length || *length > kLongestName || *length > bytes.size()) return std::nullopt;
  Hello hello;
  hello.host.assign(reinterpret_cast<const char*>(bytes.data()), *length);
  // The name is printed.
  std::replace_if(
      hello.host.begin(), hello.host.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  bytes = bytes.subspan(*length);
  const auto numbers = take<WireHello>(bytes);
  if (!numbers || numbers->nodes > kMostNodes || numbers->received > kMostNodes)
    return std::nullopt;
  if (numbers->real_time < 0 || numbers->real_time > kLatestRealTime) return std::nullopt;
  hello.real_time = Duration{numbers->real_time};
  const bool complete =
      take_each<WireNode>(
          bytes, numbers->nodes,
          [&](const WireNode& node) {
            hello.nodes.push_back({static_cast<std::uint16_t>(node.node), node.next, node.beats});
          }) &&
      take_each<WireReceived>(bytes, numbers->received, [&](const WireReceived& stream) {
        hello.received.push_back(
            {stream.host, static_cast<std::uint16_t>(stream.node), stream.expected});
      });
  if (!complete) return std::nullopt;
  if (bytes.size() % sizeof(WireEcho) != 0 || bytes.size() / sizeof(WireEcho) > kMostHosts)
    return std::nullopt;
  while (const auto echo = take<WireEcho>(bytes))
    hello.echoes.push_back({echo->host, TimePoint{echo->sent}, TimePoint{echo->received}});
  return hello;
}

}  // namespace rths::dds

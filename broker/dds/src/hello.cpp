// SPDX-License-Identifier: Apache-2.0
#include "hello.hpp"

#include <algorithm>
#include <cstring>

namespace rths::dds {
namespace {

constexpr std::size_t kLongestName = 63;
constexpr std::size_t kMostNodes = 1024;

/// A node as it is in a frame.
struct WireNode {
  std::uint64_t node, next, beats;
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
  for (const auto& node : hello.nodes)
    append(bytes, bytes_of(WireNode{node.node, node.next, node.beats}));
  return bytes;
}

std::optional<Hello> hello_from(std::span<const std::byte> bytes) {
  const auto length = take<std::uint32_t>(bytes);
  if (!length || *length > kLongestName || *length > bytes.size()) return std::nullopt;
  Hello hello;
  hello.host.assign(reinterpret_cast<const char*>(bytes.data()), *length);
  // The name is printed.
  std::replace_if(
      hello.host.begin(), hello.host.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  bytes = bytes.subspan(*length);
  if (bytes.size() % sizeof(WireNode) != 0 || bytes.size() / sizeof(WireNode) > kMostNodes)
    return std::nullopt;
  while (const auto node = take<WireNode>(bytes))
    hello.nodes.push_back({static_cast<std::uint16_t>(node->node), node->next, node->beats});
  return hello;
}

}  // namespace rths::dds

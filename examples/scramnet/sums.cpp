// SPDX-License-Identifier: Apache-2.0
//
// The other node, in C++ with this library: sends numbers and prints the sums. The map defines the
// writer of each word; a write outside the node's own partition fails.
#include <chrono>
#include <cstdio>
#include <thread>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

namespace {

using rths::LongwordOffset;

constexpr LongwordOffset kNumber{0}, kAnswer{1}, kSum{2};
constexpr std::uint32_t kLast = 10;
constexpr auto kDeadline = std::chrono::seconds{10};

bool is_answered(const rths::broker::Node& node, std::uint32_t number) {
  for (const auto deadline = std::chrono::steady_clock::now() + kDeadline;
       node.read(kAnswer) != number;) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

int run(const char* ring_name, const char* map_file) {
  auto ring = rths::broker::Ring::create(ring_name, rths::memmap::load_map(map_file));
  auto node = ring.join("sender", ring.map().hash());
  for (std::uint32_t number = 1; number <= kLast; ++number) {
    if (node.write(kNumber, number) != rths::Status::Ok) return 1;
    if (!is_answered(node, number)) {
      std::fprintf(stderr, "no answer to %u\n", number);
      return 1;
    }
    std::printf("sum of 1 to %u: %u\n", number, node.read(kSum));
  }
  rths::broker::remove_ring(ring_name);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 3) return run(argv[1], argv[2]);
    std::fprintf(stderr, "sums RING MAP\n");
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 2;
}

// SPDX-License-Identifier: Apache-2.0
//
// The cost of a trapped store through a pointer, for docs/cards.md: a program of the vendor's API
// on a replicated ring, whose messages a thread carries. x86-64 only.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <thread>

#include <rths/core/clock.hpp>
#include <rths/replicated/images.hpp>

#include <scrplus.h>

namespace {

using rths::replicated::Images;

constexpr int kBatches = 100, kStores = 50;
constexpr std::uint32_t kWord = 8;
constexpr std::size_t kBlock = 400;  // of memset [B]

rths::memmap::Map two_nodes() {
  rths::memmap::MapDescription description;
  description.name = "trap_bench";
  description.size_longwords = 1024;
  description.nodes = {{"sender", rths::NodeId{1}, ""}, {"receiver", rths::NodeId{2}, ""}};
  rths::memmap::Partition words;
  words.name = "words";
  words.node = "sender";
  words.base = rths::LongwordOffset{0};
  words.longwords = 1024;
  description.partitions = {words};
  return rths::memmap::Map{description};
}

void carry(Images& images, const std::atomic<bool>& ends) {
  rths::WallClock clock;
  const auto begin = clock.now();
  while (!ends) {
    images.advance(rths::replicated::Time{clock.now() - begin});
    clock.sleep_until(clock.now() + std::chrono::microseconds{50});
  }
}

double seconds_of_thread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Computing time of one call [µs], median of the batches. Between batches the ring sends.
template <class Store>
double time_of(Store store) {
  std::array<double, kBatches> batches{};
  for (auto& batch : batches) {
    const double begin = seconds_of_thread();
    for (int i = 0; i < kStores; ++i) store(i);
    batch = (seconds_of_thread() - begin) / kStores * 1e6;
    usleep(5000);
  }
  std::sort(batches.begin(), batches.end());
  return batches[kBatches / 2];
}

bool measure() {
  if (sp_scram_init(0) != 0) return false;
  scr_csr_write(SCR_CSR2, 0xC040);
  scr_csr_write(SCR_CSR0, 0x8103);
  auto* const words = const_cast<unsigned*>(get_base_mem());
  const double plain = time_of([&](int i) {
    asm volatile("mov %0, (%1)" ::"r"(i), "r"(words) : "memory");
  });
  scr_acr_write(kWord, ACR_TIE);
  const double made = time_of([&](int i) {
    asm volatile("mov %0, (%1)" ::"r"(i), "r"(words + kWord) : "memory");
  });
  const double filled = time_of([&](int i) { std::memset(words + kWord, i, kBlock); });
  const double stepped = time_of([&](int i) {
    asm volatile("test %0, %0; setz (%1)" ::"r"(i), "r"(words + kWord) : "memory", "cc");
  });
  std::printf(
      "{\"untrapped_us\": %.4f, \"made_by_handler_us\": %.3f, \"memset_bytes\": %zu, "
      "\"memset_us\": %.3f, \"single_step_us\": %.3f}\n",
      plain, made, kBlock, filled, stepped);
  return true;
}

}  // namespace

int main() {
  const std::string ring = "trap_bench_" + std::to_string(getpid());
  setenv("RTHS_SCRAMNET_RING", ring.c_str(), 1);
  setenv("RTHS_SCRAMNET_NODE", "sender", 1);
  Images images = Images::create(ring, two_nodes(), {});
  std::atomic<bool> ends{false};
  std::thread carrier{[&] { carry(images, ends); }};
  const bool done = measure();
  ends = true;
  carrier.join();
  return done ? 0 : 1;
}

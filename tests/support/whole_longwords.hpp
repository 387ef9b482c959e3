// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <thread>

#include "support/long_run.hpp"

namespace rths::test {

/// A longword of four equal bytes. Writers of a stress store only these, so any other one is torn.
[[nodiscard]] constexpr std::uint32_t whole_longword(std::uint32_t number) noexcept {
  return (number & 0xFFU) * 0x0101'0101U;
}
[[nodiscard]] constexpr bool is_torn(std::uint32_t longword) noexcept {
  return longword != whole_longword(longword);
}

/// When a stress ends: enough longwords moved, enough changes seen meanwhile; or out of time.
class StressEnd {
 public:
  [[nodiscard]] bool reached(std::uint64_t longwords, std::uint64_t changes) const {
    return (longwords >= longwords_ && changes >= kChanges) ||
           std::chrono::steady_clock::now() >= deadline_;
  }
  /// 10⁸ in a long trial.
  [[nodiscard]] std::uint64_t longwords() const { return longwords_; }
  static constexpr std::uint64_t kChanges = 1000;

 private:
  std::uint64_t longwords_ =
      static_cast<std::uint64_t>(Repetitions{100'000'000, 1'000'000, 100'000}.count());
  std::chrono::steady_clock::time_point deadline_ =
      std::chrono::steady_clock::now() + std::chrono::seconds{60};
};

/// Longwords seen in a stress.
struct Seen {
  std::uint64_t longwords = 0, torn = 0, changes = 0;
  std::uint32_t last = 0;

  void add(std::uint32_t longword) {
    ++longwords;
    torn += is_torn(longword) ? 1 : 0;
    changes += longword != last ? 1 : 0;
    last = longword;
  }
  /// Adds the longwords of a block of bytes, which need not be aligned.
  void add_block(const std::byte* bytes, std::size_t count) {
    for (std::size_t i = 0; i + 4 <= count; i += 4) {
      std::uint32_t longword = 0;
      std::memcpy(&longword, bytes + i, 4);
      add(longword);
    }
  }
};

/// A thread that stores whole longwords into shared words until it is stopped.
class LongwordWriter {
 public:
  explicit LongwordWriter(std::span<std::uint32_t> words)
      : thread_{[this, words] {
          for (std::uint32_t number = 1; !stop_.load(std::memory_order_relaxed); ++number)
            for (std::uint32_t& word : words)
              std::atomic_ref{word}.store(whole_longword(number), std::memory_order_relaxed);
        }} {}
  ~LongwordWriter() {
    stop_.store(true);
    thread_.join();
  }
  LongwordWriter(const LongwordWriter&) = delete;
  LongwordWriter& operator=(const LongwordWriter&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A thread that reads shared words one by one until it is stopped.
class LongwordReader {
 public:
  explicit LongwordReader(std::span<std::uint32_t> words)
      : thread_{[this, words] {
          while (!stop_.load(std::memory_order_relaxed)) {
            for (std::uint32_t& word : words)
              seen_.add(std::atomic_ref{word}.load(std::memory_order_relaxed));
            changes_.store(seen_.changes, std::memory_order_relaxed);
          }
        }} {}
  ~LongwordReader() { static_cast<void>(stop()); }
  LongwordReader(const LongwordReader&) = delete;
  LongwordReader& operator=(const LongwordReader&) = delete;

  [[nodiscard]] std::uint64_t changes() const { return changes_.load(std::memory_order_relaxed); }
  Seen stop() {
    stop_.store(true);
    if (thread_.joinable()) thread_.join();
    return seen_;
  }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> changes_{0};
  Seen seen_;
  std::thread thread_;
};

}  // namespace rths::test

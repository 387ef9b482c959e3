// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <new>
#include <type_traits>
#include <vector>

#include <rths/core/error.hpp>

namespace rths::bench {

/// Pins the calling thread to one processor during its lifetime.
class Pinned {
 public:
  /// @throws Error if the processor cannot be used   @setup
  explicit Pinned(int cpu);
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

 private:
  std::vector<unsigned char> before_;
};

/// Memory shared by this process and its child processes.
class SharedPages {
 public:
  explicit SharedPages(std::size_t bytes);
  ~SharedPages();
  SharedPages(const SharedPages&) = delete;
  SharedPages& operator=(const SharedPages&) = delete;
  [[nodiscard]] void* address() const { return address_; }

 private:
  std::size_t bytes_;
  void* address_;
};

/// One value in memory shared by this process and its child processes.
template <class T>
class Shared {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  Shared() : pages_{sizeof(T)}, value_{new (pages_.address()) T{}} {}
  T& operator*() const { return *value_; }
  T* operator->() const { return value_; }

 private:
  SharedPages pages_;
  T* value_;
};

/// The process at the other end of a measurement. The destructor kills it if it still runs; the
/// kernel kills it if this process dies.
class Partner {
 public:
  /// Forks a child that is pinned to one processor, does `work` and ends. `join` throws the error
  /// that `work` throws.   @setup
  Partner(int cpu, const std::function<void()>& work);
  ~Partner();
  Partner(const Partner&) = delete;
  Partner& operator=(const Partner&) = delete;

  /// @throws Error if the child has ended   @setup
  void expect_alive();
  /// Waits for the child's end. @throws Error with the reason if it failed   @setup
  void join();

 private:
  struct ErrorText {
    char text[256];
  };
  [[noreturn]] void work_and_end(int cpu, const std::function<void()>& work) noexcept;
  [[noreturn]] void fail() const;
  Shared<ErrorText> error_;
  pid_t pid_ = -1;
};

/// Bounds a spinning wait.
class SpinLimit {
 public:
  /// @param partner  its death also ends the wait; null in the partner itself, which the kernel
  ///                 kills with its parent
  explicit SpinLimit(Partner* partner = nullptr);
  /// Called once in every round of the wait. @throws Error after 10 s or if the partner has ended
  void count() {
    if (++rounds_ % kRoundsPerCheck == 0) check();
  }
  /// Called when the wait is over.
  void reset() { rounds_ = 0; }

 private:
  static constexpr std::uint64_t kRoundsPerCheck = 1U << 20U;  // a few milliseconds
  void check();
  Partner* partner_;
  std::uint64_t rounds_ = 0;
  std::chrono::steady_clock::time_point first_check_;
};

}  // namespace rths::bench

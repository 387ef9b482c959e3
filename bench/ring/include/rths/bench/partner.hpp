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

/// Keeps the calling thread on one processor while it lives.
class Pinned {
 public:
  /// @throws Error if the processor may not be used   @setup
  explicit Pinned(int cpu);
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

 private:
  std::vector<unsigned char> before_;
};

/// Memory that this process and those it forks see at once.
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

/// One value in memory of its own that this process and those it forks see at once.
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

/// The process at the other end of a measurement. Killed if it still runs when this object goes,
/// and by the kernel if this process dies.
class Partner {
 public:
  /// Forks. The child keeps to one processor, does `work` and ends; what `work` throws is thrown
  /// here by `join`.   @setup
  Partner(int cpu, const std::function<void()>& work);
  ~Partner();
  Partner(const Partner&) = delete;
  Partner& operator=(const Partner&) = delete;

  /// @throws Error if it has ended   @setup
  void expect_alive();
  /// Waits for its end. @throws Error with the reason if it failed   @setup
  void join();

 private:
  struct Trouble {
    char text[256];
  };
  [[noreturn]] void work_and_end(int cpu, const std::function<void()>& work) noexcept;
  [[noreturn]] void fail() const;
  Shared<Trouble> trouble_;
  pid_t pid_ = -1;
};

/// Bounds a wait that spins.
class Patience {
 public:
  /// @param partner  whose death ends the wait as well; none in the partner itself, which does
  ///                 not outlive the process that waits for it
  explicit Patience(Partner* partner = nullptr);
  /// Called once in every round of the wait. @throws Error if it takes too long, or forever
  void spend() {
    if (++rounds_ % kRoundsPerLook == 0) look();
  }
  /// What was waited for has come.
  void restore() { rounds_ = 0; }

 private:
  static constexpr std::uint64_t kRoundsPerLook = 1U << 20U;  // some milliseconds
  void look();
  Partner* partner_;
  std::uint64_t rounds_ = 0;
  std::chrono::steady_clock::time_point first_look_;
};

}  // namespace rths::bench
